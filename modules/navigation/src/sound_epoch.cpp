#include "sound_epoch.h"

#include "foucault/core/position.h"

namespace foucault::navigation {

std::optional<std::string> unsound_part(const state::Epoch& epoch) {
  if (!is_finite(epoch.position)) return "position";
  if (!epoch.velocity_n.allFinite()) return "velocity";
  if (!epoch.q_n_b.coeffs().allFinite()) return "attitude";
  if (!epoch.bias.gyro.allFinite() || !epoch.bias.accel.allFinite()) return "IMU biases";
  const bool not_negative = epoch.covariance.diagonal().minCoeff() >= 0;
  if (!not_negative || !epoch.covariance.allFinite()) return "covariance";
  return std::nullopt;
}

}  // namespace foucault::navigation
