#include "foucault/state/told_blocks.h"

namespace foucault::state {
namespace {

void turn_arm(const SlowBlock& arm, const Eigen::Matrix3d& R, Epoch& epoch) {
  const Eigen::Index row = state_size(arm.index);
  StateMatrix& P = epoch.covariance;
  epoch.slow.segment<3>(arm.index) = (R * epoch.slow.segment<3>(arm.index)).eval();
  P.middleRows<3>(row) = (R * P.middleRows<3>(row)).eval();
  P.middleCols<3>(row) = (P.middleCols<3>(row) * R.transpose()).eval();
}

}  // namespace

Epoch as_users_know(const Epoch& epoch, const Told& told) {
  Epoch whole = epoch;
  const Eigen::Matrix3d R_v_b = told.q_v_b.toRotationMatrix();
  if (const SlowBlock* offset = told.layout.find(block::time_offset)) {
    whole.slow[offset->index] += told.time_offset_s;
  }
  if (const SlowBlock* arm = told.layout.find(block::lever_arm)) {
    whole.slow.segment<3>(arm->index) += told.lever_arm_b;
    turn_arm(*arm, R_v_b, whole);
  }
  if (const SlowBlock* arm = told.layout.find(block::wheel_lever_arm)) turn_arm(*arm, R_v_b, whole);
  return whole;
}

Epoch prior_as_users_know(const Told& told) {
  return as_users_know(with_slow_blocks({}, told.layout), told);
}

}  // namespace foucault::state
