#include "foucault/measurement/zero_velocity.h"

namespace foucault::measurement {

state::Linearized ZeroVelocity::linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                                          const state::Layout& layout) const {
  state::Linearized z(3, layout.size());
  z.r = -x.velocity_n;
  state::columns_of(z.H, state::block::velocity).setIdentity();
  z.R = sigma_ * sigma_ * Eigen::Matrix3d::Identity();
  return z;
}

}  // namespace foucault::measurement
