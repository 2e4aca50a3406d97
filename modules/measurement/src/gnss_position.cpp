#include "foucault/measurement/gnss_position.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

GnssPosition::GnssPosition(const GnssFix& fix)
    : antenna_(fix.antenna), p_b_a_(fix.p_b_a), covariance_n_(fix.position_covariance) {}

Linearized GnssPosition::linearize(const NavState& x, const Eigen::Vector3d& /*rate_b*/,
                                   const Layout& layout) const {
  const Eigen::Matrix3d C = x.q_n_b.toRotationMatrix();
  Linearized z(3, layout.size());
  z.r = displacement_n(x.position, antenna_, Place(x.position)) - C * p_b_a_;
  columns_of(z.H, block::position).setIdentity();
  columns_of(z.H, block::attitude) = -C * so3::skew(p_b_a_);
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_position(const GnssFix& fix) { return std::make_shared<GnssPosition>(fix); }

}  // namespace foucault::measurement
