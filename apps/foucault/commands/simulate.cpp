#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "arguments.h"
#include "command.h"
#include "foucault/laboratory/fault_cases.h"
#include "jobs/simulation_job.h"

namespace foucault::app {
namespace {

std::string fault_help() {
  std::string help = fmt::format("What is wrong with it; faults of the middle begin at {:.0f} s:",
                                 laboratory::kFaultStart);
  for (const laboratory::FaultCase& fault : laboratory::fault_cases()) {
    help += fmt::format("\n  {}: {}", fault.name, fault.title);
  }
  return help;
}

}  // namespace

std::function<void(Call&)> declare_simulate(CLI::App& app) {
  struct Options {
    std::optional<std::string> imu;
    std::optional<double> duration;
    std::optional<int64_t> seed;
    std::string fault = laboratory::fault_cases().front().name;
    ConfigArguments config;
    std::string out;
  };
  const auto o = std::make_shared<Options>();
  app.add_option("--imu", o->imu, "IMU preset, short for --set imu.preset=NAME");
  app.add_option("--duration", o->duration, "Length [s], short for --set scenario.duration_s=N");
  app.add_option("--seed", o->seed, "Seed of trip and noise, short for --set scenario.seed=N");
  app.add_option("--fault", o->fault, fault_help())->capture_default_str();
  add_config_options(app, o->config, [] {
    SimulationSettings settings;
    return describe_config(settings);
  });
  add_output_option(app, o->out, "Rawlog to write")->required();
  app.footer(
      "\nExamples:\n"
      "  foucault simulate --imu ADIS16465 --duration 600 --seed 7 --out trip.rawlog\n"
      "  foucault simulate --duration 460 --fault ramp --out ramp.rawlog\n"
      "  foucault simulate --set scenario.name=motorway --set scenario.gnss_rate_hz=5 --out "
      "m.rawlog\n"
      "  foucault simulate --set scenario.name=boat --set scenario.skip_s=60 --out b.rawlog");
  return [o](Call& call) {
    SimulationSettings settings;
    apply(o->config, settings);
    if (o->imu) settings.imu.preset = *o->imu;
    settings.imu = settings.imu.completed_by({});
    if (o->duration) set_config(fmt::format("scenario.duration_s={}", *o->duration), settings);
    if (o->seed) set_config(fmt::format("scenario.seed={}", *o->seed), settings);
    const SimulationCounts counts =
        write_simulation(settings, laboratory::find_fault_case(o->fault), o->out, call.console);
    call.console.say(fmt::format(
        "{}: {:.1f} s of '{}' with {}, {} IMU samples, {} fixes, {} wheel "
        "speeds, {} poses of the truth",
        o->out, settings.scenario.duration_s, settings.scenario.name, settings.imu.preset,
        counts.imu_samples, counts.fixes, counts.wheel_speeds, counts.reference_poses));
  };
}

}  // namespace foucault::app
