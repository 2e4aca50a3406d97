#include "foucault/state/vehicle_attitude.h"

#include "foucault/state/mounting_turn.h"

namespace foucault::state {

VehicleAttitude vehicle_attitude(const Epoch& epoch, const Mounting& mounting) {
  VehicleAttitude attitude;
  const SlowBlock* estimated = mounting.estimated ? &*mounting.estimated : nullptr;
  const MountingTurn turn(epoch.slow, estimated);
  const Eigen::Quaterniond q_v_b = Eigen::Quaterniond(turn.matrix()) * mounting.q_v_b;
  attitude.q_n_v = epoch.q_n_b * q_v_b.conjugate();
  RowsByState<3> J = RowsByState<3>::Zero(3, epoch.covariance.cols());
  columns_of(J, block::attitude) = q_v_b.toRotationMatrix();
  if (estimated) columns_of(J, *estimated) = -turn.axes_v();
  attitude.covariance_v = J * epoch.covariance * J.transpose();
  attitude.euler = so3::to_euler(attitude.q_n_v);
  const Eigen::Matrix3d by_v = so3::euler_jacobian(attitude.euler);
  attitude.sigma =
      (by_v * attitude.covariance_v * by_v.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
  return attitude;
}

}  // namespace foucault::state
