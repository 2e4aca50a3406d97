#pragma once

#include <Eigen/Core>

#include "foucault/state/told_blocks.h"

namespace foucault::state {

/// Velocity of the IMU over the ground along the vehicle's forward, right, down.
struct VehicleVelocity {
  Eigen::Vector3d velocity_v;                              ///< [m/s]
  Eigen::Matrix3d covariance_v = Eigen::Matrix3d::Zero();  ///< of its error, first order
};

/// M R_v_b R_n_b' v_n, M the MountingTurn.
VehicleVelocity vehicle_velocity(const Epoch& epoch, const Told& told);

}  // namespace foucault::state
