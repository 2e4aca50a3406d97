#include <memory>

#include "command.h"
#include "config_arguments.h"
#include "foucault/evaluation/task_pool.h"
#include "tune_job.h"

namespace foucault::app {
namespace {

std::string config_help() {
  TuneOptions options;
  Settings settings;
  return "Keys of the grid's file:\n" + describe_config(options) +
         "base: and grid: take the keys of the configuration:\n" + describe_config(settings);
}

}  // namespace

std::function<void(Call&)> declare_tune(CLI::App& app) {
  struct Options {
    TuneJob job;
    ConfigArguments config;
    bool no_report = false;
  };
  const auto o = std::make_shared<Options>();
  o->job.threads = processor_count();
  app.add_option("LOG", o->job.logs, "Rawlogs")->required();
  add_config_options(app, o->config, config_help);
  app.get_option("--config")->required()->description("The grid, YAML");
  app.get_option("--set")->description("One key of the base; may be repeated");
  app.add_option("--jobs", o->job.threads, "Runs at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--out", o->job.out, "Folder for points.csv, results.csv, best.yaml, report/")
      ->required();
  app.add_flag("--no-report", o->no_report, "Draw no figures");
  app.footer(
      "\nExample of a grid:\n"
      "  base: {imu: {preset: ADIS16465}}      # any keys of the configuration\n"
      "  grid:\n"
      "    imu.arw_deg_sqrt_h: [0.05, 0.1, 0.2, 0.4]\n"
      "    imu.gyro_bias_deg_h: {from: 1, to: 100, steps: 9, scale: log}\n"
      "  method: rough                         # or methods: [refined, rough]\n"
      "  objective: horizontal                 # vertical; weighted\n"
      "  search: coarse_to_fine                # full\n"
      "Finished points are kept in DIR/points.csv: after a kill the same command goes on there.");
  return [o](Call& call) {
    o->job.config = load_tune_config(o->config.file, o->config.assignments);
    o->job.report = !o->no_report;
    o->job.command_line = call.command_line;
    for (const std::string& line : tune(o->job, call.console)) call.console.say(line);
  };
}

}  // namespace foucault::app
