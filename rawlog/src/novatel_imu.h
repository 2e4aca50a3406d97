#pragma once

#include <optional>
#include <string>

#include "novatel_file.h"

/// Inertial units as NovAtel's documentation has them: numbers ("Table: IMU Type") and counts
/// ("Table: Raw IMU Scale Factors").
namespace foucault::rawlog {

/// What a count of RAWIMU is.
struct NovatelScales {
  double gyro = 0;   ///< [rad]
  double accel = 0;  ///< [m/s]
};

const NovatelNames& novatel_imu_names();

/// In words for messages.
std::string novatel_imu_name(int type);

/// None of a type that is not known.
std::optional<NovatelScales> novatel_scales(int type);

}  // namespace foucault::rawlog
