#pragma once

#include "foucault/core/measurement.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Azimuth of the baseline of two antennas, of u_n = C exp(-s omega) u, s the time offset where it
/// is estimated, omega = (rate_b - bias) / (1 + scale) by axis, u in b by the told direction and
/// the block `baseline_heading`.
/// d(azimuth) = g' d(u_n), g = (-u_e, u_n, 0) over their squares; d(u_n) = -C [u x] d by the
/// attitude and -C (omega x u) by s. A baseline that is steeper than 70 deg tells nothing.
class Heading final : public Observation {
 public:
  /// q_v_b: as told. Precondition: the fix has a heading.
  Heading(const GnssFix& fix, const Eigen::Quaterniond& q_v_b);

  std::string_view name() const override { return "heading"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  GnssHeading heading_;
  Eigen::Matrix3d C_b_v_;
  double since_first_;
};

}  // namespace foucault::measurement
