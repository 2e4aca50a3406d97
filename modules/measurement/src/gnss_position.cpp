#include "foucault/measurement/gnss_position.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

GnssPosition::GnssPosition(const GnssFix& fix)
    : antenna_(fix.antenna), p_b_a_(fix.p_b_a), covariance_n_(fix.position_covariance) {}

state::Linearized GnssPosition::linearize(const state::NavState& x,
                                          const Eigen::Vector3d& /*rate_b*/,
                                          const state::Layout& layout) const {
  const Eigen::Matrix3d C = x.q_n_b.toRotationMatrix();
  state::Linearized z(3, layout.size());
  z.r = geodesy::displacement_n(x.position, antenna_, geodesy::Place(x.position)) - C * p_b_a_;
  state::columns_of(z.H, state::block::position).setIdentity();
  state::columns_of(z.H, state::block::attitude) = -C * so3::skew(p_b_a_);
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_position(const GnssFix& fix) { return std::make_shared<GnssPosition>(fix); }

}  // namespace foucault::measurement
