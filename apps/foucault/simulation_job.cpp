#include "simulation_job.h"

#include <variant>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::app {
namespace {

void count(const Measurement& measurement, SimulationCounts& counts) {
  if (std::holds_alternative<ImuIncrement>(measurement)) ++counts.imu_samples;
  if (std::holds_alternative<GnssFix>(measurement)) ++counts.fixes;
  if (std::holds_alternative<ReferencePose>(measurement)) ++counts.reference_poses;
}

}  // namespace

void SimulationSettings::fields(ConfigFields& f) {
  f.section("imu", imu, "IMU: noise that is simulated");
  f.section("scenario", scenario, "the trip and its sensors");
}

SimulationCounts write_simulation(const SimulationSettings& settings, const std::string& path,
                                  Console& console) {
  if (settings.imu.sample_kind() != SampleKind::interval_mean) {
    throw UsageError("imu.samples: simulated samples are means over intervals; use interval_mean");
  }
  SimulatedSource source(settings.scenario, settings.imu.noise());
  RawlogWriter writer(path, source.mounting());
  SimulationCounts counts;
  while (const std::optional<Measurement> measurement = source.next()) {
    writer.write(*measurement);
    count(*measurement, counts);
    console.progress("simulating", source.progress());
  }
  writer.finish();
  return counts;
}

}  // namespace foucault::app
