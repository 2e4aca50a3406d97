#include "foucault/state/vehicle_velocity.h"

#include "foucault/core/so3.h"

namespace foucault::state {

VehicleVelocity vehicle_velocity(const Epoch& epoch, const Told& told) {
  const SlowBlock* mounting = told.layout.find(block::mounting);
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  if (mounting) turn.tail<2>() = epoch.slow.segment<2>(mounting->index);
  const Eigen::Matrix3d M = so3::exp(turn).toRotationMatrix();
  const Eigen::Matrix3d R_b_n = epoch.q_n_b.toRotationMatrix().transpose();
  const Eigen::Matrix3d by_b = M * told.q_v_b.toRotationMatrix();
  const Eigen::Vector3d v_b = R_b_n * epoch.velocity_n;
  const Eigen::Vector3d told_v = told.q_v_b * v_b;

  RowsByState<3> J = RowsByState<3>::Zero(3, epoch.covariance.cols());
  columns_of(J, block::velocity) = by_b * R_b_n;
  columns_of(J, block::attitude) = by_b * so3::skew(v_b);
  if (mounting) {
    columns_of(J, *mounting) = -(M * so3::skew(told_v) * so3::right_jacobian(turn)).rightCols<2>();
  }
  return {M * told_v, J * epoch.covariance * J.transpose()};
}

}  // namespace foucault::state
