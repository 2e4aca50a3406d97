#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "foucault/core/so3.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::state {

/// Attitude of the vehicle (forward-right-down) in the local North-East-Down, from an epoch, whose
/// attitude is the IMU's.
struct VehicleAttitude {
  Eigen::Quaterniond q_n_v = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_v = Eigen::Matrix3d::Zero();  ///< of the right perturbation, v [rad^2]
  so3::Euler euler;                                        ///< [rad]
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  ///< of roll, pitch, heading [rad], first order
};

/// q_n_v = q_n_b * q_v_b^-1 * M^-1, M the MountingTurn; the perturbation turns as dtheta_v =
/// M R_v_b dtheta_b - A d(pitch, heading), A its axes.
VehicleAttitude vehicle_attitude(const Epoch& epoch, const Mounting& mounting);

}  // namespace foucault::state
