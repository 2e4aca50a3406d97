#pragma once

#include "foucault/measurement/body_stretch.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Velocity of the point of the vehicle that does not slip, in the vehicle's axes, averaged over a
/// stretch: M C_v_b (u + omega x l), M the state::MountingTurn, l the block `wheel_lever_arm`,
/// omega the mean rate less the bias.
struct VehiclePoint {
  Eigen::Vector3d velocity_v;
  state::RowsByState<3> H;  ///< by all blocks of the layout
  double turn_rate = 0;     ///< mean, about the vehicle's downward axis [rad/s]
  state::StateVector turn_rate_gradient;
};
VehiclePoint vehicle_point(const BodyStretch& stretch, const Eigen::Matrix3d& C_v_b,
                           const state::NavState& x, const state::Layout& layout);

}  // namespace foucault::measurement
