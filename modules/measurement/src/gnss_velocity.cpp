#include "foucault/measurement/gnss_velocity.h"

#include "foucault/core/so3.h"

namespace foucault {

GnssVelocity::GnssVelocity(const GnssFix& fix)
    : velocity_n_(*fix.velocity_n), p_b_a_(fix.p_b_a), covariance_n_(fix.velocity_covariance) {}

Linearized GnssVelocity::linearize(const NavState& x, const Eigen::Vector3d& rate_b,
                                   const Layout& layout) const {
  const Eigen::Matrix3d C = x.q_n_b.toRotationMatrix();
  const Eigen::Vector3d swing_b = (rate_b - x.bias.gyro).cross(p_b_a_);
  Linearized z(3, layout.size());
  z.r = velocity_n_ - x.velocity_n - C * swing_b;
  columns_of(z.H, block::velocity).setIdentity();
  columns_of(z.H, block::attitude) = -C * so3::skew(swing_b);
  columns_of(z.H, block::gyro_bias) = C * so3::skew(p_b_a_);
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_velocity(const GnssFix& fix) { return std::make_shared<GnssVelocity>(fix); }

}  // namespace foucault
