#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "jobs/allan_job.h"

namespace foucault::app {

std::function<void(Call&)> declare_allan(CLI::App& app) {
  struct Options {
    AllanJob job;
    ConfigArguments config;
    bool no_report = false;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "LOG", o->job.log, "Rawlog that rests somewhere")->required();
  add_config_options(app, o->config, settings_help);
  add_output_option(app, o->job.out, "Folder for allan.csv, metrics.json, report/")->required();
  add_no_report_flag(app, o->no_report);
  app.footer(
      "\nRests are found in the log; a log of a vehicle that never moves is one rest. White noise\n"
      "takes a minute, bias instability and rate random walk take hours; what the length does not\n"
      "show is named. Spectra of the sensors at rest and in motion name vibrations.\n"
      "Examples:\n"
      "  foucault allan bench.rawlog --out noise\n"
      "  foucault allan drive.rawlog --set imu.bias_tau_s=1000 --out drive-noise");
  return [o](Call& call) {
    apply(o->config, o->job.settings);
    o->job.report = !o->no_report;
    o->job.command_line = call.command_line;
    call.console.say(summary_lines(allan(o->job, call.console)));
  };
}

}  // namespace foucault::app
