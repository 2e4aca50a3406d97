#include "known_biases.h"

#include "foucault/state/kalman.h"

namespace foucault::navigation {
namespace {

/// The slow blocks as they were, so uncertain that the update decides about them; unless the
/// alignment has some, correlated with the rest.
Epoch with_slow_blocks_of(const Epoch& earlier, const Epoch& aligned) {
  if (aligned.slow.size() == earlier.slow.size()) return aligned;
  constexpr double kVague = 1e4;
  const Eigen::Index size = state_size(earlier.slow.size());
  Epoch out = aligned;
  out.slow = earlier.slow;
  out.covariance = StateMatrix::Zero(size, size);
  node_part(out.covariance) = node_part(aligned.covariance);
  slow_part(out.covariance) = kVague * slow_part(earlier.covariance);
  return out;
}

}  // namespace

Epoch with_known_biases(const Epoch& aligned, const Epoch& earlier) {
  constexpr double kVarianceGrows = 4;
  Epoch out = with_slow_blocks_of(earlier, aligned);
  const StateVector gone = boxminus(earlier, out);
  const int known = static_cast<int>(sensor_part(gone).size());
  LinearizedState z(known, static_cast<int>(gone.size()));
  z.r = sensor_part(gone);
  z.H.rightCols(known).setIdentity();
  z.R = kVarianceGrows * earlier.covariance.bottomRightCorner(known, known);
  kalman_update(z, out, out.covariance);
  return out;
}

}  // namespace foucault::navigation
