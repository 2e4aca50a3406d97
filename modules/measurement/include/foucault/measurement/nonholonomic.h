#pragma once

#include "foucault/measurement/body_stretch.h"
#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// Wheels roll forward: the velocity of the point that does not slip, to the right and downward, is
/// zero on the mean of a stretch; with a cornering compliance k that to the right is -k a u, u the
/// forward speed, a = u times the turn rate the acceleration to the right, of the means. Blocks:
/// mounting, wheel_lever_arm, cornering_compliance.
class Nonholonomic final : public Observation {
 public:
  /// sigma: of the mean to the right and of that downward [m/s].
  Nonholonomic(const BodyStretch& stretch, const Eigen::Quaterniond& q_v_b,
               const Eigen::Vector2d& sigma);

  std::string_view name() const override { return "nonholonomic"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  BodyStretch stretch_;
  Eigen::Matrix3d C_v_b_;
  Eigen::Vector2d sigma_;
};

}  // namespace foucault::measurement
