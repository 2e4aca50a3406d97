#include "foucault/state/told_blocks.h"

#include "foucault/state/mounting_turn.h"

namespace foucault::state {
namespace {

/// l_v = M R_v_b l_b, M the MountingTurn.
void turn_arm(const SlowBlock& arm, const Told& told, Epoch& epoch) {
  const SlowBlock* mounting = told.layout.find(block::mounting);
  const MountingTurn turn(epoch.slow, mounting);
  const Eigen::Vector3d told_v = told.q_v_b * Eigen::Vector3d(epoch.slow.segment<3>(arm.index));
  epoch.slow.segment<3>(arm.index) = turn.matrix() * told_v;

  StateMatrix J = StateMatrix::Identity(told.layout.size(), told.layout.size());
  part(J, arm, arm) = turn.matrix() * told.q_v_b.toRotationMatrix();
  if (mounting) part(J, arm, *mounting) = turn.gradient(told_v);
  epoch.covariance = (J * epoch.covariance * J.transpose()).eval();
}

}  // namespace

Epoch as_users_know(const Epoch& epoch, const Told& told) {
  Epoch whole = epoch;
  if (const SlowBlock* offset = told.layout.find(block::time_offset)) {
    whole.slow[offset->index] += told.time_offset_s;
  }
  if (const SlowBlock* arm = told.layout.find(block::lever_arm)) {
    whole.slow.segment<3>(arm->index) += told.lever_arm_b;
    turn_arm(*arm, told, whole);
  }
  if (const SlowBlock* arm = told.layout.find(block::wheel_lever_arm)) turn_arm(*arm, told, whole);
  return whole;
}

Epoch prior_as_users_know(const Told& told) {
  Epoch prior = with_slow_blocks({}, told.layout);
  const SlowBlock* mounting = told.layout.find(block::mounting);
  if (!mounting) return as_users_know(prior, told);
  const Eigen::Matrix2d of_mounting = part(prior.covariance, *mounting, *mounting);
  part(prior.covariance, *mounting, *mounting).setZero();
  prior = as_users_know(prior, told);
  part(prior.covariance, *mounting, *mounting) = of_mounting;
  return prior;
}

}  // namespace foucault::state
