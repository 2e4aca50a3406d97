#pragma once

#include <optional>
#include <string>

#include "foucault/rawlog/import.h"

namespace foucault::rawlog {

/// Text files of the i2Nav group (the paper's data), columns separated by blanks, '#' and '%' begin
/// comments, plain or gzip. Times are GPS seconds of week.
/// IMU: sow, dtheta x y z [rad], dvel x y z [m/s] over (t - dt, t]; axes forward-right-down;
///   an 8th column is the odometer's speed [m/s], with a 9th their mean (two wheels).
/// GNSS: sow, latitude, longitude [deg], ellipsoidal height [m], sigma north, east, down [m];
///   13 columns: then velocity north, east, down [m/s] and its three sigmas.
/// Reference (.nav): week, sow, latitude, longitude [deg], height [m], velocity north, east, down
///   [m/s], roll, pitch, heading [deg] of the IMU.
/// Wheel: sow, speed [m/s], separated by blanks or commas; a first line may name them. Rows without
///   a speed are counted.
struct I2navImport : ImportOptions {
  std::string imu;
  std::string gnss;
  std::optional<std::string> reference;
  std::optional<std::string> wheel;
  std::optional<int> gps_week;  ///< of the first row; without it the reference's
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();  ///< IMU to antenna, forward-right-down [m]
  FixQuality quality = FixQuality::unknown;             ///< of all fixes: the file does not say
};

/// The seconds of week may run over into the next week within a log.
ImportSummary import_i2nav(const I2navImport& options);

}  // namespace foucault::rawlog
