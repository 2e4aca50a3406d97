#include "foucault/measurement/gnss_velocity.h"

#include "antenna.h"

namespace foucault::measurement {

GnssVelocity::GnssVelocity(const GnssFix& fix)
    : velocity_n_(*fix.velocity_n),
      p_b_a_(fix.p_b_a),
      since_first_(fix.since_first_s),
      covariance_n_(fix.velocity_covariance) {}

state::Linearized GnssVelocity::linearize(const state::NavState& x, const MeanMotion& mean,
                                          const state::Layout& layout) const {
  const Antenna antenna(x, mean, layout, p_b_a_, since_first_);
  state::Linearized z(3, layout.size());
  z.r = velocity_n_ - antenna.velocity_n + antenna.offset * antenna.acceleration_n;
  state::columns_of(z.H, state::block::velocity).setIdentity();
  antenna.add_swing(1, z);
  if (antenna.has_time()) {
    antenna.put_time(-antenna.acceleration_n, z);
    antenna.add_acceleration(-antenna.offset, z);
  }
  z.R = covariance_n_;
  return z;
}

ObservationPtr gnss_velocity(const GnssFix& fix) { return std::make_shared<GnssVelocity>(fix); }

}  // namespace foucault::measurement
