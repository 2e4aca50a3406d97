#include "foucault/measurement/gnss_velocity.h"

#include "foucault/core/so3.h"

namespace foucault::measurement {

GnssVelocity::GnssVelocity(const GnssFix& fix)
    : velocity_n_(*fix.velocity_n), p_b_a_(fix.p_b_a), covariance_n_(fix.velocity_covariance) {}

state::Linearized GnssVelocity::linearize(const state::NavState& x, const Eigen::Vector3d& rate_b,
                                          const state::Layout& layout) const {
  const Eigen::Matrix3d C = x.q_n_b.toRotationMatrix();
  const Eigen::Array3d scale = 1 + layout.imu_scale(x.slow).gyro.array();
  const Eigen::Vector3d omega_b = (rate_b - x.bias.gyro).array() / scale;
  const Eigen::Vector3d swing_b = omega_b.cross(p_b_a_);
  const Eigen::Matrix3d by_omega = -C * so3::skew(p_b_a_);
  state::Linearized z(3, layout.size());
  z.r = velocity_n_ - x.velocity_n - C * swing_b;
  state::columns_of(z.H, state::block::velocity).setIdentity();
  state::columns_of(z.H, state::block::attitude) = -C * so3::skew(swing_b);
  state::columns_of(z.H, state::block::gyro_bias) =
      -by_omega * scale.inverse().matrix().asDiagonal();
  if (const state::SlowBlock* gyro_scale = layout.find(state::block::gyro_scale))
    state::columns_of(z.H, *gyro_scale) =
        -by_omega * (omega_b.array() / scale).matrix().asDiagonal();
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_velocity(const GnssFix& fix) { return std::make_shared<GnssVelocity>(fix); }

}  // namespace foucault::measurement
