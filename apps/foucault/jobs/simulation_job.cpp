#include "jobs/simulation_job.h"

#include <memory>
#include <utility>
#include <variant>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "foucault/simulation/faults.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::app {
namespace {

using laboratory::FaultCase;

void count(const Measurement& measurement, SimulationCounts& counts) {
  if (std::holds_alternative<ImuIncrement>(measurement)) ++counts.imu_samples;
  if (std::holds_alternative<GnssFix>(measurement)) ++counts.fixes;
  if (std::holds_alternative<WheelSpeed>(measurement)) ++counts.wheel_speeds;
  if (std::holds_alternative<ReferencePose>(measurement)) ++counts.reference_poses;
}

std::unique_ptr<state::Source> make_source(const SimulationSettings& settings,
                                           const FaultCase& fault) {
  simulation::ScenarioOptions scenario = settings.scenario;
  if (fault.sigma_m) scenario.gnss_sigma_m = {*fault.sigma_m, *fault.sigma_m, 2 * *fault.sigma_m};
  auto source = std::make_unique<simulation::SimulatedSource>(scenario, settings.imu.noise());
  if (fault.faults.empty()) return source;
  return std::make_unique<simulation::FaultySource>(std::move(source), fault.faults, scenario.seed);
}

}  // namespace

void SimulationSettings::fields(ConfigFields& f) {
  f.section("imu", imu, "IMU: noise that is simulated");
  f.section("scenario", scenario, "the trip and its sensors");
}

SimulationCounts write_simulation(const SimulationSettings& settings, const std::string& path,
                                  Console& console) {
  return write_simulation(settings, FaultCase(), path, console);
}

SimulationCounts write_simulation(const SimulationSettings& settings, const FaultCase& fault,
                                  const std::string& path, Console& console) {
  if (settings.imu.preset == "auto")
    throw UsageError("imu.preset: auto is learned from a recording; name the IMU to simulate");
  if (settings.imu.sample_kind() != imu::SampleKind::interval_mean) {
    throw UsageError("imu.samples: simulated samples are means over intervals; use interval_mean");
  }
  const std::unique_ptr<state::Source> source = make_source(settings, fault);
  rawlog::RawlogWriter writer(
      path, source->mounting(),
      fault.faults.empty() ? rawlog::WrittenValues::finite : rawlog::WrittenValues::any);
  SimulationCounts counts;
  while (const std::optional<Measurement> measurement = source->next()) {
    writer.write(*measurement);
    count(*measurement, counts);
    console.progress("simulating", source->progress());
  }
  writer.finish();
  laboratory::damage_file(path, fault.damage);
  return counts;
}

}  // namespace foucault::app
