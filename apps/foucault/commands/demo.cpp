#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "command.h"
#include "output_directory.h"
#include "run_job.h"
#include "simulation_job.h"

namespace foucault::app {
namespace {

SimulationSettings demo_trip() {
  SimulationSettings settings;
  settings.imu.preset = "ADIS16465";
  settings.scenario.name = "city";
  settings.scenario.duration_s = 900;
  settings.scenario.seed = 7;
  return settings;
}

RunResult run_demo(const std::string& out, const std::string& command_line, Console& console) {
  OutputDirectory directory(out);
  const SimulationSettings trip = demo_trip();
  RunJob job;
  job.log = (directory.staging() / "trip.rawlog").string();
  job.out = out;
  job.settings.imu.preset = trip.imu.preset;
  job.command_line = command_line;
  console.say(fmt::format("simulating {:.0f} s of '{}' with an {}", trip.scenario.duration_s,
                          trip.scenario.name, trip.imu.preset));
  write_simulation(trip, job.log, console);
  const RunResult result = run_into(job, directory.staging(), console);
  directory.commit();
  return result;
}

}  // namespace

std::function<void(Call&)> declare_demo(CLI::App& app) {
  const auto out = std::make_shared<std::string>("foucault-demo");
  app.add_option("--out", *out, "Folder for the recording, its solution and its report")
      ->capture_default_str();
  return [out](Call& call) {
    const RunResult result = run_demo(*out, call.command_line, call.console);
    for (const std::string& line : summary_lines(result)) call.console.say(line);
  };
}

}  // namespace foucault::app
