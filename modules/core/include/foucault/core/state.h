#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The layout of the error state, shared by EKF, factors and marginalization.
/// Order [dp dv dtheta dbg dba]; dtheta is a right perturbation, q = q_hat * exp(dtheta).
namespace foucault {

namespace error_state {
constexpr int kPosition = 0;    ///< dp [m]
constexpr int kVelocity = 3;    ///< dv [m/s]
constexpr int kAttitude = 6;    ///< dtheta, in b [rad]
constexpr int kGyroBias = 9;    ///< dbg [rad/s]
constexpr int kAccelBias = 12;  ///< dba [m/s^2]
constexpr int kSize = 15;
}  // namespace error_state

using Vector15d = Eigen::Matrix<double, 15, 1>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;

/// Biases of an IMU; subtracted from its measurements.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s], b
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2], b
};

}  // namespace foucault
