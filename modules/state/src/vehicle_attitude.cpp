#include "foucault/state/vehicle_attitude.h"

namespace foucault::state {

VehicleAttitude vehicle_attitude(const Epoch& epoch, const Mounting& mounting) {
  VehicleAttitude attitude;
  attitude.q_n_v = epoch.q_n_b * mounting.q_v_b.conjugate();
  const Eigen::Matrix3d covariance_b = epoch.covariance_of(block::attitude);
  const Eigen::Matrix3d R_v_b = mounting.q_v_b.toRotationMatrix();
  attitude.covariance_v = R_v_b * covariance_b * R_v_b.transpose();
  attitude.euler = so3::to_euler(attitude.q_n_v);
  const Eigen::Matrix3d J = so3::euler_jacobian(attitude.euler);
  attitude.sigma = (J * attitude.covariance_v * J.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
  return attitude;
}

}  // namespace foucault::state
