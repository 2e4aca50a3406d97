#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "jobs/run_job.h"
#include "methods.h"

namespace foucault::app {
namespace {

std::string method_help() {
  std::string help = "Method:";
  for (const methods::Method& method : methods::all()) {
    help += fmt::format("\n  {}: {}", method.name, method.summary);
  }
  return help;
}

/// Also where the summary is not shown.
void warn_if_condemned(const Trust& trust, Console& console) {
  if (trust.trustworthy) return;
  console.warn(fmt::format("not trustworthy: {}", fmt::join(trust.reasons, "; ")));
}

}  // namespace

std::function<void(Call&)> declare_run(CLI::App& app) {
  struct Options {
    RunJob job;
    ConfigArguments config;
    bool no_report = false;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "LOG", o->job.log, "Rawlog to process")->required();
  app.add_option("--method", o->job.method, method_help())->capture_default_str();
  add_config_options(app, o->config, settings_help);
  add_output_option(app, o->job.out, "Folder for solution.csv, .tum, .kml, metrics.json, report/")
      ->required();
  add_no_report_flag(app, o->no_report);
  app.add_flag("--profile", o->job.profile, "Say where the time went, stage by stage");
  app.footer(
      "\nExamples:\n"
      "  foucault run trip.rawlog --out trip\n"
      "  foucault run trip.rawlog --method refined --set imu.preset=ICM20602 --out trip-refined\n"
      "  foucault run trip.rawlog --config car.yaml --set output.rate=imu --out trip\n"
      "The configuration that was in force is written to DIR/config.yaml, ready for --config.");
  return [o](Call& call) {
    apply(o->config, o->job.settings);
    o->job.report = !o->no_report;
    o->job.command_line = call.command_line;
    const RunResult result = run(o->job, call.console);
    warn_if_condemned(result.metrics.trust, call.console);
    call.console.say(summary_lines(result));
    if (result.damage) {
      throw DataError(fmt::format("{}; the results in '{}' are of what came before", *result.damage,
                                  result.out));
    }
  };
}

}  // namespace foucault::app
