#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "arguments.h"
#include "command.h"
#include "foucault/core/error.h"
#include "foucault/evaluation/task_pool.h"
#include "jobs/evaluation_job.h"
#include "methods.h"
#include "output_directory.h"
#include "version.h"

namespace foucault::app {
namespace {

const std::vector<std::string> kPaperMethods{"ekf", "refined", "rough"};

struct EvaluateOptions {
  std::vector<std::string> logs;
  std::vector<std::string> methods = kPaperMethods;
  ConfigArguments config;
  int jobs = evaluation::processor_count();
  std::string out;
  bool ablate = false;
  bool no_report = false;
  bool paper = false;
};

EvaluationLabels labels(Settings settings, const std::string& command_line) {
  EvaluationLabels labels;
  labels.remarks = {
      "Fixes were withheld from the methods for a while, again and again. Drift is the distance "
      "between estimate and truth meanwhile; the tables and bars take the largest of each outage, "
      "as the paper does."};
  labels.origin = {command_line, dump_config(settings), kVersion};
  return labels;
}

void evaluate_logs(const EvaluateOptions& options, Call& call) {
  Settings settings = options.paper ? Settings::of_paper() : Settings();
  apply(options.config, settings);
  const std::vector<std::string>& methods = options.paper ? kPaperMethods : options.methods;
  Ablation ablation{cross(options.logs, methods, settings), {}};
  if (options.ablate) ablation = with_parts_off(ablation.cases);
  OutputDirectory directory(options.out);
  Evaluation evaluation = evaluate_what_is_there(ablation.cases, options.jobs, call.console);
  const evaluation::EvaluationSummary summary(std::move(evaluation.results));
  EvaluationLabels texts = labels(settings, call.command_line);
  texts.ablation = ablation.names;
  write_evaluation(summary, texts, !options.no_report, directory.staging(), call.console);
  directory.commit();
  call.console.say(options.ablate ? evaluation::ablation_lines(summary, ablation.names)
                                  : evaluation::evaluation_lines(summary));
  call.console.say(written_lines(options.out, !options.no_report));
  std::vector<std::string> lacking = evaluation.damages;
  lacking.insert(lacking.end(), evaluation.failures.begin(), evaluation.failures.end());
  if (!lacking.empty()) {
    throw DataError(fmt::format("{}; the results in '{}' are of what is there",
                                fmt::join(lacking, "; "), options.out));
  }
}

}  // namespace

std::function<void(Call&)> declare_evaluate(CLI::App& app) {
  const auto o = std::make_shared<EvaluateOptions>();
  add_input_option(app, "LOG", o->logs, "Rawlogs")->required();
  app.add_flag("--paper", o->paper,
               "The paper's comparison: ekf, refined and rough with 15 states and position fixes "
               "alone (aids.mode and calibrate.mode none)");
  app.add_option("--methods", o->methods, fmt::format("Of {}", method_names()))
      ->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->capture_default_str();
  app.add_flag(
      "--ablate", o->ablate,
      "Also with each aid switched off that is used, all aids, calibration, and both: what "
      "each is worth");
  add_config_options(app, o->config, settings_help);
  add_jobs_option(app, o->jobs);
  add_output_option(app, o->out, "Folder for drift.csv, metrics.json, tables/, report/")
      ->required();
  add_no_report_flag(app, o->no_report);
  app.footer(
      "\nExamples:\n"
      "  foucault evaluate trip.rawlog --out trip-outages\n"
      "  foucault evaluate a.rawlog b.rawlog --config car.yaml --methods ekf,refined --out both\n"
      "  foucault evaluate trip.rawlog --methods ekf --ablate --out trip-worth\n"
      "  foucault evaluate short.rawlog --set outages.first_s=85 --set outages.length_s=15 \\\n"
      "      --set outages.period_s=45 --set outages.shifts_s=[0] --out short\n"
      "Outages come from the keys outages.* of the configuration; by default 60 s every 150 s "
      "after "
      "510 s,\nand again with starts 75 s later.");
  return [o](Call& call) { evaluate_logs(*o, call); };
}

}  // namespace foucault::app
