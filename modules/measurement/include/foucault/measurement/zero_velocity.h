#pragma once

#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// A vehicle that stands still has no velocity relative to the Earth.
class ZeroVelocity final : public Observation {
 public:
  explicit ZeroVelocity(double sigma) : sigma_(sigma) {}  ///< each axis [m/s]

  std::string_view name() const override { return "zero_velocity"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  double sigma_;
};

}  // namespace foucault::measurement
