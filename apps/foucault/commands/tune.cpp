#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "command.h"
#include "foucault/evaluation/task_pool.h"
#include "jobs/tune_job.h"

namespace foucault::app {
namespace {

std::string config_help() {
  tuning::TuneOptions options;
  return "Keys of the grid's file:\n" + describe_config(options) +
         "base: and grid: take the keys of the configuration:\n" + settings_help();
}

}  // namespace

std::function<void(Call&)> declare_tune(CLI::App& app) {
  struct Options {
    TuneJob job;
    ConfigArguments config;
    StoreArguments store;
    int jobs = evaluation::processor_count();
    bool no_report = false;
  };
  const auto o = std::make_shared<Options>();
  add_input_option(app, "LOG", o->job.logs, "Rawlogs")->required();
  add_config_options(app, o->config, config_help);
  app.get_option("--config")->required()->description("The grid, YAML");
  app.get_option("--set")->description("One key of the base; may be repeated");
  add_jobs_option(app, o->jobs);
  add_output_option(app, o->job.out, "Folder for results.csv, points.csv, best.yaml, report/")
      ->required();
  add_no_report_flag(app, o->no_report);
  add_store_options(app, o->store);
  app.footer(
      "\nExample of a grid:\n"
      "  base: {imu: {preset: ADIS16465}}      # any keys of the configuration\n"
      "  grid:\n"
      "    imu.arw_deg_sqrt_h: [0.05, 0.1, 0.2, 0.4]\n"
      "    imu.gyro_bias_deg_h: {from: 1, to: 100, steps: 9, scale: log}\n"
      "  method: rough                         # or methods: [refined, rough]\n"
      "  objective: horizontal                 # vertical; weighted\n"
      "  search: coarse_to_fine                # full\n"
      "\nExamples:\n"
      "  foucault tune trip.rawlog --config grid.yaml --out trip-tuned\n"
      "  foucault tune a.rawlog b.rawlog --config grid.yaml --set outages.length_s=30 --out both\n"
      "\nFinished runs are kept, by default in .DIR.foucault-records until the results are "
      "written:\n"
      "after a kill the same command goes on there.");
  return [o](Call& call) {
    load_grid(o->config.file, o->config.assignments, o->job);
    o->job.report = !o->no_report;
    o->job.command_line = call.command_line;
    RunStore store(o->store, o->job.out, o->jobs);
    store.keep_if_stopped(call.console,
                          [&] { call.console.say(tune(o->job, store, call.console)); });
    store.finish();
  };
}

}  // namespace foucault::app
