#pragma once

#include <Eigen/Core>

#include "foucault/core/measurement.h"

namespace foucault::imu {

/// Means of what the IMU measured over the last seconds, not compensated.
struct RecentRates {
  double memory_s = 0;                                ///< that is looked back to
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double seen_s = 0;                                  ///< that the means rest on

  void add(const ImuIncrement& increment);
};

/// What swings with a lever arm: a mean over some samples, since vibration changes the rate from
/// one to the next by more than the motion does, and short against any turn.
constexpr double kLeverArmRateMemory = 0.05;  // [s]

}  // namespace foucault::imu
