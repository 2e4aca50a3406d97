#include "known_biases.h"

#include "foucault/state/kalman.h"

namespace foucault::navigation {
namespace {

/// The slow blocks as they were, so uncertain that the update decides about them; unless the
/// alignment has some, correlated with the rest.
state::Epoch with_slow_blocks_of(const state::Epoch& earlier, const state::Epoch& aligned) {
  if (aligned.slow.size() == earlier.slow.size()) return aligned;
  constexpr double kVague = 1e4;
  const Eigen::Index size = state::state_size(earlier.slow.size());
  state::Epoch out = aligned;
  out.slow = earlier.slow;
  out.covariance = state::StateMatrix::Zero(size, size);
  state::node_part(out.covariance) = state::node_part(aligned.covariance);
  state::slow_part(out.covariance) = kVague * state::slow_part(earlier.covariance);
  return out;
}

}  // namespace

state::Epoch with_known_biases(const state::Epoch& aligned, const state::Epoch& earlier) {
  constexpr double kVarianceGrows = 4;
  state::Epoch out = with_slow_blocks_of(earlier, aligned);
  const state::StateVector gone = state::boxminus(earlier, out);
  const int known = static_cast<int>(state::sensor_part(gone).size());
  state::LinearizedState z(known, static_cast<int>(gone.size()));
  z.r = state::sensor_part(gone);
  z.H.rightCols(known).setIdentity();
  z.R = kVarianceGrows * earlier.covariance.bottomRightCorner(known, known);
  state::kalman_update(z, out, out.covariance);
  return out;
}

}  // namespace foucault::navigation
