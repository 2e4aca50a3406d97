/// A measurement of your own, in every method: the distance to a beacon. Fixes end after 150 s;
/// ranges to two beacons are what is left. Prints how far each method is off 45 s later; smoothers
/// know what was measured afterwards. `own_measurement none`: without ranges.

#include <cstdio>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/predicted.h"
#include "foucault/methods/methods.h"
#include "foucault/simulation/simulated_source.h"
#include "foucault/state/epoch_sink.h"
using namespace foucault;

double distance(const Geodetic& a, const Geodetic& b) { return geodesy::ned_offset(a, b).norm(); }

/// All that a new measurement is: its value and sigma [m], and how a state predicts it.
measurement::ObservationPtr beacon_range(double metres, const Geodetic& beacon) {
  const auto predict = [beacon](const state::NavState& x) { return distance(x.position, beacon); };
  return measurement::predicted("beacon_range", metres, 0.05, predict);
}

int main(int argc, char**) {
  simulation::ScenarioOptions trip;
  const int64_t outage_ns = trip.start_ns() + nanoseconds(150);
  const int64_t looked_ns = trip.start_ns() + nanoseconds(195);
  trip.duration_s = 200;
  const geodesy::LocalFrame w(trip.start_position());
  const Geodetic beacons[] = {w.to_geodetic({200, 150, -30}), w.to_geodetic({-150, 200, -30})};
  methods::MethodOptions options;
  options.run.imu = imu::imu_preset("ICM20602");
  for (const methods::Method& method : methods::all()) {
    simulation::SimulatedSource source(trip, options.run.imu);
    state::EpochSink sink([&](const state::Epoch& e) {
      const double off = distance(e.position, source.truth(e.t_ns).position);
      if (e.t_ns == looked_ns) std::printf("%s,%.4f\n", method.name.c_str(), off);
    });
    const auto run = method.make(options, sink);
    while (const auto m = source.next()) {
      const bool withheld = std::holds_alternative<GnssFix>(*m) && stamp(*m) > outage_ns;
      if (!withheld) run->process(*m);
      if (!withheld || argc > 1) continue;
      const Geodetic here = source.truth(stamp(*m)).position;
      for (const Geodetic& beacon : beacons)
        run->observe(stamp(*m), beacon_range(distance(here, beacon), beacon));
    }
    run->finish();
  }
}
