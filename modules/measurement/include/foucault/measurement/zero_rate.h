#pragma once

#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// The mean rate of a vehicle that stands still, is the Earth's: (rate - bias) / (1 + scale) = C'
/// omega_ie.
class ZeroRate final : public Observation {
 public:
  /// rate_b: mean of what was measured, not compensated [rad/s]; sigma: of it, each axis.
  ZeroRate(const Eigen::Vector3d& rate_b, double sigma) : rate_b_(rate_b), sigma_(sigma) {}

  std::string_view name() const override { return "zero_rate"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  Eigen::Vector3d rate_b_;
  double sigma_;
};

}  // namespace foucault::measurement
