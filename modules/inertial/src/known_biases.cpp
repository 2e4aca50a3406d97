#include "known_biases.h"

#include "foucault/state/kalman.h"

namespace foucault {
namespace {

constexpr int kFirst = block::gyro_bias.offset;

StateVector of_sensors(const NavState& x) {
  StateVector values(kNodeSize - kFirst + x.slow.size());
  values << x.bias.gyro, x.bias.accel, x.slow;
  return values;
}

/// The slow blocks as they were, so uncertain that the update decides about them.
Epoch with_slow_blocks_of(const Epoch& earlier, const Epoch& aligned) {
  constexpr double kVague = 1e4;
  const Eigen::Index slow = earlier.slow.size();
  Epoch out = aligned;
  out.slow = earlier.slow;
  out.covariance = StateMatrix::Zero(kNodeSize + slow, kNodeSize + slow);
  node_part(out.covariance) = node_part(aligned.covariance);
  out.covariance.bottomRightCorner(slow, slow) =
      kVague * earlier.covariance.bottomRightCorner(slow, slow);
  return out;
}

}  // namespace

Epoch with_known_biases(const Epoch& aligned, const Epoch& earlier) {
  constexpr double kVarianceGrows = 4;
  Epoch out = with_slow_blocks_of(earlier, aligned);
  const int known = static_cast<int>(out.covariance.rows()) - kFirst;
  LinearizedRows<kMostSize> z(known, static_cast<int>(out.covariance.cols()));
  z.r = of_sensors(earlier) - of_sensors(out);
  z.H.rightCols(known).setIdentity();
  z.R = kVarianceGrows * earlier.covariance.bottomRightCorner(known, known);
  kalman_update(z, out, out.covariance);
  return out;
}

}  // namespace foucault
