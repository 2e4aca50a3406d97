#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "jobs/learn_job.h"

namespace foucault::app {

std::function<void(Call&)> declare_learn(CLI::App& app) {
  struct Options {
    LearnJob job;
    ConfigArguments config;
    bool no_report = false;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "LOG", o->job.logs, "Rawlogs of one vehicle")->required();
  add_config_options(app, o->config, settings_help);
  add_output_option(app, o->job.out, "Folder for learned.yaml, metrics.json, report/")->required();
  add_no_report_flag(app, o->no_report);
  app.footer(
      "\nA filter goes through each log; then the noise is sought with which its predictions are\n"
      "as far off as they say, for the next fix and 5 to 60 s ahead without fixes. No truth and "
      "no\n"
      "outages are needed. What the recordings do not tell stays as it was told, and is named.\n"
      "Examples:\n"
      "  foucault learn drive.rawlog --out noise\n"
      "  foucault learn monday.rawlog tuesday.rawlog --set imu.preset=ICM20602 --out noise\n"
      "  foucault run wednesday.rawlog --config noise/learned.yaml --out wednesday");
  return [o](Call& call) {
    apply(o->config, o->job.settings);
    o->job.report = !o->no_report;
    o->job.command_line = call.command_line;
    call.console.say(summary_lines(learn(o->job, call.console)));
  };
}

}  // namespace foucault::app
