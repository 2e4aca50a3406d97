/// A measurement of your own in every method: distances to two beacons, which are what is left when
/// fixes end. Prints errors at the end [m]; `own_measurement none`: those without distances.
#include <cstdio>

#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/predicted.h"
#include "foucault/methods/methods.h"
#include "foucault/simulation/simulated_source.h"
#include "foucault/state/epoch_sink.h"
using namespace foucault;

/// All that a new measurement is: how a state predicts it [m].
Eigen::Vector2d to_beacons(const state::NavState& x) {
  const Geodetic a{30.4518 * kDegree, 114.4716 * kDegree, 50};
  const Geodetic b{30.4487 * kDegree, 114.4721 * kDegree, 50};
  return {geodesy::ned_offset(a, x.position).norm(), geodesy::ned_offset(b, x.position).norm()};
}

int main(int argc, char**) {
  simulation::ScenarioOptions trip;
  trip.duration_s = 200;
  methods::MethodOptions options;
  options.run.imu = imu::imu_preset("ICM20602");
  for (const methods::Method& method : methods::all()) {
    simulation::SimulatedSource source(trip, options.run.imu);
    state::Epoch last;
    state::EpochSink sink([&last](const state::Epoch& epoch) { last = epoch; });
    const auto run = method.make(options, sink);
    while (const auto m = source.next()) {
      const bool withheld = source.progress() > 0.75 && std::holds_alternative<GnssFix>(*m);
      if (!withheld) run->process(*m);
      if (!withheld || argc > 1) continue;
      const Eigen::Vector2d metres = to_beacons(source.truth(stamp(*m)));
      run->observe(stamp(*m), measurement::predicted("to_beacons", metres, 0.05, to_beacons));
    }
    run->finish();
    const Geodetic truth = source.truth(last.t_ns).position;
    std::printf("%s,%.4f\n", method.name.c_str(), geodesy::ned_offset(truth, last.position).norm());
  }
}
