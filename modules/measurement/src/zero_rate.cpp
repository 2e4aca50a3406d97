#include "foucault/measurement/zero_rate.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

/// measured = (1 + scale) C' omega_ie + bias.
state::Linearized ZeroRate::linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                                      const state::Layout& layout) const {
  const Eigen::Vector3d earth_b = x.q_n_b.conjugate() * geodesy::Place(x.position).omega_ie_n;
  const Eigen::Vector3d by_scale = Eigen::Vector3d::Ones() + layout.imu_scale(x.slow).gyro;
  state::Linearized z(3, layout.size());
  z.r = rate_b_ - x.bias.gyro - by_scale.cwiseProduct(earth_b);
  state::columns_of(z.H, state::block::gyro_bias).setIdentity();
  state::columns_of(z.H, state::block::attitude) = by_scale.asDiagonal() * so3::skew(earth_b);
  if (const state::SlowBlock* scale = layout.find(state::block::gyro_scale))
    state::columns_of(z.H, *scale) = earth_b.asDiagonal();
  z.R = sigma_ * sigma_ * Eigen::Matrix3d::Identity();
  return z;
}

}  // namespace foucault::measurement
