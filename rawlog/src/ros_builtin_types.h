#pragma once

namespace foucault::rawlog {

/// Definitions of the types of ROS 2 that a recording of a vehicle has and old recordings do not
/// define, each behind a line "MSG: package/Type".
/// Source: the interfaces of ROS 2 (docs.ros.org: std_msgs, geometry_msgs, sensor_msgs, nav_msgs).
extern const char* const kRosBuiltinTypes;

}  // namespace foucault::rawlog
