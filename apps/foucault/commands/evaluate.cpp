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
  std::vector<std::string> methods{"ekf", kDefaultMethod};
  ConfigArguments config;
  StoreArguments store;
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

/// What is to be compared, and how it is told.
struct EvaluationPlan {
  Ablation ablation;
  EvaluationLabels labels;
};

EvaluationPlan plan_of(const EvaluateOptions& options, const std::string& command_line) {
  Settings settings = options.paper ? Settings::of_paper() : Settings();
  apply(options.config, settings);
  const std::vector<std::string>& methods = options.paper ? kPaperMethods : options.methods;
  Ablation ablation{cross(options.logs, methods, settings)};
  if (options.ablate) ablation = with_parts_off(ablation.cases);
  EvaluationPlan plan{std::move(ablation), labels(settings, command_line)};
  plan.labels.ablation = plan.ablation.names;
  return plan;
}

void write_results(const EvaluationPlan& plan, const EvaluateOptions& options, RunStore& store,
                   Console& console) {
  OutputDirectory directory(options.out);
  const Evaluation evaluation =
      evaluate_what_is_there(plan.ablation, store, directory.staging(), console);
  write_evaluation(evaluation, plan.labels, !options.no_report, directory.staging(), console);
  directory.commit();
  store.finish();
  const evaluation::EvaluationSummary& summary = *evaluation.summary;
  console.say(options.ablate ? evaluation::ablation_lines(summary, plan.labels.ablation)
                             : evaluation::evaluation_lines(summary));
  console.say(written_lines(options.out, !options.no_report));
  std::vector<std::string> lacking = evaluation.damages;
  lacking.insert(lacking.end(), evaluation.failures.begin(), evaluation.failures.end());
  if (!lacking.empty()) {
    throw DataError(fmt::format("{}; the results in '{}' are of what is there",
                                fmt::join(lacking, "; "), options.out));
  }
}

void evaluate_logs(const EvaluateOptions& options, Call& call) {
  const EvaluationPlan plan = plan_of(options, call.command_line);
  RunStore store(options.store, options.out, options.jobs);
  store.keep_if_stopped(call.console, [&] {
    if (store.is_worker()) {
      evaluate_what_is_there(plan.ablation, store, {}, call.console);
    } else {
      write_results(plan, options, store, call.console);
    }
  });
}

}  // namespace

std::function<void(Call&)> declare_evaluate(CLI::App& app) {
  const auto o = std::make_shared<EvaluateOptions>();
  add_input_option(app, "LOG", o->logs, "Rawlogs")->required();
  app.add_flag("--paper", o->paper,
               "The paper's comparison: ekf, refined and rough with 15 states and position fixes "
               "alone (aids.mode and calibrate.mode none)");
  app.add_option("--methods", o->methods, fmt::format("Of {}", methods::names()))
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
  add_store_options(app, o->store);
  app.footer(
      "\nExamples:\n"
      "  foucault evaluate trip.rawlog --out trip-outages\n"
      "  foucault evaluate a.rawlog b.rawlog --config car.yaml --methods ekf,refined --out both\n"
      "  foucault evaluate trip.rawlog --methods ekf --ablate --out trip-worth\n"
      "  foucault evaluate short.rawlog --set outages.first_s=85 --set outages.length_s=15 \\\n"
      "      --set outages.period_s=45 --set outages.shifts_s=[0] --out short\n"
      "  foucault evaluate *.rawlog --out all --store runs --shard auto    one of many workers\n"
      "Outages come from the keys outages.* of the configuration; by default 60 s every 150 s "
      "after "
      "510 s,\nand again with starts 75 s later.");
  return [o](Call& call) { evaluate_logs(*o, call); };
}

}  // namespace foucault::app
