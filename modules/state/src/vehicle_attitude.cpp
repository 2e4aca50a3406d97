#include "foucault/state/vehicle_attitude.h"

namespace foucault::state {

VehicleAttitude vehicle_attitude(const Epoch& epoch, const Mounting& mounting) {
  VehicleAttitude attitude;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  const std::optional<SlowBlock>& estimated = mounting.estimated;
  if (estimated) turn.tail<2>() = epoch.slow.segment<2>(estimated->index);
  const Eigen::Quaterniond M = so3::exp(turn);
  attitude.q_n_v = epoch.q_n_b * (M * mounting.q_v_b).conjugate();
  RowsByState<3> J = RowsByState<3>::Zero(3, epoch.covariance.cols());
  columns_of(J, block::attitude) = (M * mounting.q_v_b).toRotationMatrix();
  if (estimated)
    columns_of(J, *estimated) = -(M.toRotationMatrix() * so3::right_jacobian(turn)).rightCols<2>();
  attitude.covariance_v = J * epoch.covariance * J.transpose();
  attitude.euler = so3::to_euler(attitude.q_n_v);
  const Eigen::Matrix3d by_v = so3::euler_jacobian(attitude.euler);
  attitude.sigma =
      (by_v * attitude.covariance_v * by_v.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
  return attitude;
}

}  // namespace foucault::state
