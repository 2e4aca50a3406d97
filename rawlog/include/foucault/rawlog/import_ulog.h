#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"

namespace foucault::rawlog {

/// A ULog of PX4, plain or gzip; axes forward-right-down.
/// IMU: increments of `vehicle_imu` where they were logged without holes, else `sensor_combined`.
/// GNSS: `vehicle_gps_position`, else `sensor_gps`: fixes of three dimensions, their heights above
///   the ellipsoid where the receiver gives them, sigmas eph, epv and s_variance_m_s.
/// Time: the fixes' UTC, to which the clock since boot is fitted, its drift included; without UTC
///   the log begins in 1970. How long a receiver takes to send a fix is not known here: it is part
///   of the time offset of IMU and GNSS.
struct UlogImport : ImportOptions {
  std::string log;
  /// IMU to antenna, forward-right-down [m]; without it that of the log's parameters.
  std::optional<Eigen::Vector3d> lever_arm;
};

ImportSummary import_ulog(const UlogImport& options);

}  // namespace foucault::rawlog
