#pragma once

#include <Eigen/Core>
#include <vector>

#include "foucault/core/measurement.h"

namespace foucault::alignment {

/// Measured velocities lag, and IMU stamps are late, by up to this [s].
constexpr double kVelocityLatency = 0.1;

/// Motion of the antenna over a stretch, estimated from its fixes.
struct MotionFit {
  Eigen::Vector3d begin_velocity_n = Eigen::Vector3d::Zero();  ///< [m/s], at the first fix
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();        ///< [m/s], at the last fix
  Eigen::Vector3d acceleration_n = Eigen::Vector3d::Zero();    ///< mean over the stretch [m/s^2]
  /// Of begin_velocity_n and acceleration_n.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double duration = 0;  ///< [s]
};

/// Kalman filter over fixes, in order, with an acceleration that wanders as that of a vehicle does;
/// positions, and velocities where positions are coarse. Axes are taken as independent.
MotionFit fit_motion(const std::vector<GnssFix>& fixes);

/// Velocity of fixes on a straight line, in time, horizontally [m/s].
struct MotionLine {
  Eigen::Vector2d velocity_n = Eigen::Vector2d::Zero();
  double sigma = 0;
};
/// By least squares of positions and measured velocities. Precondition: two fixes or more.
MotionLine fit_line(const std::vector<GnssFix>& fixes);

/// Whether the velocity of a fix says more of the motion than its position.
bool velocity_is_better(const GnssFix& fix);

}  // namespace foucault::alignment
