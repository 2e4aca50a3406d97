#include "trip.h"

#include <optional>
#include <utility>
#include <variant>

#include "foucault/simulation/simulated_source.h"

namespace foucault::benchmarks {

Trip simulated_trip(double duration_s, double gnss_rate_hz) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = duration_s;
  scenario.gnss_rate_hz = gnss_rate_hz;
  scenario.seed = 7;
  Trip trip;
  trip.noise = imu::imu_preset("ADIS16465");
  simulation::SimulatedSource source(scenario, trip.noise);
  trip.mounting = source.mounting();
  while (std::optional<Measurement> measurement = source.next()) {
    if (std::holds_alternative<ImuIncrement>(*measurement)) ++trip.samples;
    if (std::holds_alternative<GnssFix>(*measurement)) ++trip.fixes;
    trip.measurements.push_back(std::move(*measurement));
  }
  return trip;
}

}  // namespace foucault::benchmarks
