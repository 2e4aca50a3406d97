#include "foucault/measurement/gnss_position.h"

#include "antenna.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

GnssPosition::GnssPosition(const GnssFix& fix)
    : antenna_(fix.antenna),
      p_b_a_(fix.p_b_a),
      since_first_(fix.since_first_s),
      covariance_n_(fix.position_covariance) {}

state::Linearized GnssPosition::linearize(const state::NavState& x, const MeanMotion& mean,
                                          const state::Layout& layout) const {
  const Antenna antenna(x, mean, layout, p_b_a_, since_first_);
  const double offset = antenna.offset;
  state::Linearized z(3, layout.size());
  z.r = geodesy::displacement_n(x.position, antenna_, geodesy::Place(x.position)) -
        antenna.C * antenna.l_b + offset * antenna.velocity_n -
        0.5 * offset * offset * antenna.acceleration_n;
  state::columns_of(z.H, state::block::position).setIdentity();
  state::columns_of(z.H, state::block::attitude) = -antenna.C * so3::skew(antenna.l_b);
  if (antenna.lever_arm) state::columns_of(z.H, *antenna.lever_arm) = antenna.C;
  if (antenna.has_time()) {
    antenna.put_time(offset * antenna.acceleration_n - antenna.velocity_n, z);
    state::columns_of(z.H, state::block::velocity).diagonal().setConstant(-offset);
    antenna.add_swing(-offset, z);
    antenna.add_acceleration(0.5 * offset * offset, z);
  }
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_position(const GnssFix& fix) { return std::make_shared<GnssPosition>(fix); }

}  // namespace foucault::measurement
