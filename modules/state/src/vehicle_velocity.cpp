#include "foucault/state/vehicle_velocity.h"

#include "foucault/core/so3.h"
#include "foucault/state/mounting_turn.h"

namespace foucault::state {

VehicleVelocity vehicle_velocity(const Epoch& epoch, const Told& told) {
  const SlowBlock* mounting = told.layout.find(block::mounting);
  const MountingTurn turn(epoch.slow, mounting);
  const Eigen::Matrix3d R_b_n = epoch.q_n_b.toRotationMatrix().transpose();
  const Eigen::Matrix3d by_b = turn.matrix() * told.q_v_b.toRotationMatrix();
  const Eigen::Vector3d v_b = R_b_n * epoch.velocity_n;
  const Eigen::Vector3d told_v = told.q_v_b * v_b;

  RowsByState<3> J = RowsByState<3>::Zero(3, epoch.covariance.cols());
  columns_of(J, block::velocity) = by_b * R_b_n;
  columns_of(J, block::attitude) = by_b * so3::skew(v_b);
  if (mounting) columns_of(J, *mounting) = turn.gradient(told_v);
  return {turn.matrix() * told_v, J * epoch.covariance * J.transpose()};
}

}  // namespace foucault::state
