#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import.h"

namespace foucault::rawlog {

/// A recording of ROS: a bag of ROS 1 (format 2.0), MCAP, or rosbag 2, its folder or a file of it
/// (sqlite3), plain or compressed; which, tell the first bytes. Messages are read by the
/// definitions in it, else by those of ROS 2's own types.
///
/// IMU: what has angular_velocity and linear_acceleration, as sensor_msgs/Imu; on the sensor's
///   axes, which look forward, left, up (REP 103) unless told otherwise.
///
/// GNSS: what has latitude, longitude [deg] and altitude [m, above the ellipsoid], as
///   sensor_msgs/NavSatFix with its status (corrections from satellites or stations: differential)
///   and covariance; where there is none, sentences of NMEA (nmea_msgs/Sentence), by their time.
///
/// Velocity: geometry_msgs/TwistStamped or TwistWithCovarianceStamped, east, north, up, of the same
///   stamps as the fixes.
///
/// Time: the stamp of the message's header; where that is zero, of the recording.
struct BagImport : ImportOptions {
  std::string bag;                        ///< file or folder
  std::optional<std::string> imu_topic;   ///< without it the only one that has what it needs
  std::optional<std::string> gnss_topic;  ///< the same
  std::optional<std::string> velocity_topic;
  std::vector<std::string> imu_axes = {"x", "-y", "-z"};  ///< as ImuMapping::axes
  /// North, east, down, where the messages do not tell [m], [m/s].
  std::optional<Eigen::Vector3d> gnss_sigma, velocity_sigma;
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();  ///< IMU to antenna, forward-right-down [m]
};

ImportSummary import_bag(const BagImport& options);

}  // namespace foucault::rawlog
