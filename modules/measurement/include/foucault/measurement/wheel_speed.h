#pragma once

#include "foucault/measurement/body_stretch.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Forward velocity of the point that does not slip = (1 + scale) times what the wheels tell, on
/// the mean of the instants of a stretch, which times its length is the way that they rolled.
/// Blocks: wheel_scale, mounting, wheel_lever_arm.
class WheelSpeedMean final : public Observation {
 public:
  /// speed: mean of what was told at the instants of the stretch [m/s]; sigma: of that mean.
  WheelSpeedMean(const BodyStretch& stretch, const Eigen::Quaterniond& q_v_b, double speed,
                 double sigma);

  std::string_view name() const override { return "wheel_speed"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  BodyStretch stretch_;
  Eigen::Matrix3d C_v_b_;
  double speed_, sigma_;
};

}  // namespace foucault::measurement
