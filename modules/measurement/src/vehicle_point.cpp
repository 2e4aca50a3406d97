#include "vehicle_point.h"

#include "foucault/core/so3.h"
#include "foucault/state/mounting_turn.h"

namespace foucault::measurement {

VehiclePoint vehicle_point(const BodyStretch& stretch, const Eigen::Matrix3d& C_v_b,
                           const state::NavState& x, const state::Layout& layout) {
  const BodyVelocity u = body_velocity(stretch, x);
  const state::SlowBlock* arm = layout.find(state::block::wheel_lever_arm);
  const state::SlowBlock* mounting = layout.find(state::block::mounting);
  const Eigen::Vector3d omega_b = stretch.rate_b - x.bias.gyro;
  Eigen::Vector3d l_b = Eigen::Vector3d::Zero();
  if (arm) l_b = x.slow.segment<3>(arm->index);
  const state::MountingTurn turn(x.slow, mounting);
  const Eigen::Matrix3d& M = turn.matrix();
  const Eigen::Vector3d told_v = C_v_b * (u.value_b + omega_b.cross(l_b));
  const Eigen::Matrix3d by_b = M * C_v_b;

  VehiclePoint point;
  point.velocity_v = M * told_v;
  point.H.setZero(3, layout.size());
  point.H.leftCols(u.J.cols()) = by_b * u.J;
  state::columns_of(point.H, state::block::gyro_bias) += by_b * so3::skew(l_b);
  if (arm) state::columns_of(point.H, *arm) = by_b * so3::skew(omega_b);
  if (mounting) state::columns_of(point.H, *mounting) = turn.gradient(told_v);
  const Eigen::Vector3d told_rate_v = C_v_b * omega_b;
  point.turn_rate = (M * told_rate_v).z();
  point.turn_rate_gradient.setZero(layout.size());
  state::part(point.turn_rate_gradient, state::block::gyro_bias) = -by_b.row(2).transpose();
  if (mounting) {
    state::part(point.turn_rate_gradient, *mounting) =
        turn.gradient(told_rate_v).bottomRows<1>().transpose();
  }
  return point;
}

}  // namespace foucault::measurement
