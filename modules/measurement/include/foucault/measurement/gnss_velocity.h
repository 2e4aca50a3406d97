#pragma once

#include "foucault/core/measurement.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Velocity of the antenna, v + C (omega x l), omega = (rate_b - bias) / (1 + scale) by axis.
/// d(v_a) = dv - C [(omega x l) x] d + C [l x] (dbg + omega dscale) / (1 + scale)
/// + C [omega x] dl; where the time offset s is estimated, v_a - s a_a.
class GnssVelocity final : public Observation {
 public:
  /// Precondition: the fix has a velocity.
  explicit GnssVelocity(const GnssFix& fix);

  std::string_view name() const override { return "gnss_velocity"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  Eigen::Vector3d velocity_n_;
  Eigen::Vector3d p_b_a_;
  double since_first_;
  Eigen::Matrix3d covariance_n_;
};

ObservationPtr gnss_velocity(const GnssFix& fix);

}  // namespace foucault::measurement
