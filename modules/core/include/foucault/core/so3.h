#pragma once

#include <Eigen/Geometry>

/// Rotations: Hamilton quaternions, right perturbation `q = q_hat * exp(dtheta)`.
/// All functions keep full precision at tiny angles and are right up to pi.
namespace foucault::so3 {

/// [v x], so that skew(a) * b = a.cross(b).
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Rotation vector [rad] to unit quaternion. Paper (2).
Eigen::Quaterniond exp(const Eigen::Vector3d& rotation);

/// Unit quaternion to rotation vector [rad], norm in [0, pi].
Eigen::Vector3d log(const Eigen::Quaterniond& q);

/// Right Jacobian Jr: exp(r + d) = exp(r) * exp(Jr(r) d) to first order in d.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& rotation);

/// Inverse of Jr: log(exp(r) * exp(d)) = r + Jr^-1(r) d to first order; |rotation| < 2 pi.
Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& rotation);

/// Roll, pitch, heading [rad] of a forward-right-down frame in North-East-Down (ZYX order).
/// heading in [0, 2 pi), pitch in [-pi/2, pi/2], roll in (-pi, pi].
struct Euler {
  double roll = 0;
  double pitch = 0;
  double heading = 0;
};

Euler to_euler(const Eigen::Quaterniond& q_n_v);
Eigen::Quaterniond from_euler(const Euler& euler);

/// d(roll, pitch, heading) / d(dtheta_v) for q_n_v * exp(dtheta_v), rows roll, pitch, heading.
/// Grows without bound as pitch nears +-pi/2, as Euler angles do.
Eigen::Matrix3d euler_jacobian(const Euler& euler);

/// Angle wrapped to (-pi, pi].
double wrap(double angle);

}  // namespace foucault::so3
