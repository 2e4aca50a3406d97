#pragma once

#include "foucault/core/measurement.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Position of the antenna, p + C l; paper (50). p_a = p + C exp(d) l, hence
/// d(p_a) = dp - C [l x] d + C dl. Where the time offset s is estimated it is that of s earlier,
/// p_a - s v_a + s^2/2 a_a, with the acceleration of the stamp: a jerk of 2 m/s^3 is worth 0.3 mm
/// at 0.1 s, 9 mm at 0.3 s.
///
/// d(p_a)/ds is -v_a as it is estimated, with the noise of the last fixes in it. If errors of fixes
/// last (0.5 s and more), that goes with the next innovation, and what a filter finds of s is off
/// by as much as 3 sigmas; graphs, that take v_a from fixes on both sides, are not.
class GnssPosition final : public Observation {
 public:
  explicit GnssPosition(const GnssFix& fix);

  std::string_view name() const override { return "gnss_position"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  Geodetic antenna_;
  Eigen::Vector3d p_b_a_;
  double since_first_;
  Eigen::Matrix3d covariance_n_;
};

ObservationPtr gnss_position(const GnssFix& fix);

}  // namespace foucault::measurement
