#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "command.h"
#include "config_arguments.h"
#include "evaluation_job.h"
#include "evaluation_output.h"
#include "evaluation_report.h"
#include "foucault/core/error.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/page/report_page.h"
#include "methods.h"
#include "output_directory.h"

namespace foucault::app {
namespace {

struct EvaluateOptions {
  std::vector<std::string> logs;
  std::vector<std::string> methods{"ekf", "refined", "rough"};
  ConfigArguments config;
  int jobs = processor_count();
  std::string out;
  bool no_report = false;
};

std::string config_help() {
  Settings settings;
  return describe_config(settings);
}

EvaluationLabels labels(Settings settings, const std::string& command_line) {
  EvaluationLabels labels;
  labels.remarks = {
      "Fixes were withheld from the methods for a while, again and again. Drift is the distance "
      "between estimate and truth meanwhile; the tables and bars take the largest of each outage, "
      "as the paper does."};
  labels.command_line = command_line;
  labels.config = dump_config(settings);
  return labels;
}

void evaluate_logs(const EvaluateOptions& options, Call& call) {
  Settings settings;
  apply(options.config, settings);
  const std::vector<EvaluationCase> cases = cross(options.logs, options.methods, settings);
  OutputDirectory directory(options.out);
  Evaluation evaluation = evaluate_what_is_there(cases, options.jobs, call.console);
  const EvaluationSummary summary(std::move(evaluation.results));
  const EvaluationLabels with = labels(settings, call.command_line);
  write_evaluation(summary, with, directory.staging());
  if (!options.no_report) {
    call.console.progress("drawing", 0);
    page::write_report(content::evaluation_page(evaluation_report(summary, with)),
                       (directory.staging() / "report").string());
  }
  directory.commit();
  for (const std::string& line : evaluation_lines(summary)) call.console.say(line);
  call.console.say(fmt::format("{:<10} {}", "written", options.out));
  if (!options.no_report) {
    const std::filesystem::path page = std::filesystem::path(options.out) / "report" / "index.html";
    call.console.say(fmt::format("{:<10} {}", "report", page.string()));
  }
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
  app.add_option("LOG", o->logs, "Rawlogs")->required();
  app.add_option("--methods", o->methods, fmt::format("Of {}", method_names()))
      ->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->capture_default_str();
  add_config_options(app, o->config, config_help);
  app.add_option("--jobs", o->jobs, "Runs at the same time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--out", o->out, "Folder for drift.csv, metrics.json, tables/, report/")
      ->required();
  app.add_flag("--no-report", o->no_report, "Draw no figures");
  app.footer(
      "\nExamples:\n"
      "  foucault evaluate trip.rawlog --out trip-outages\n"
      "  foucault evaluate a.rawlog b.rawlog --config car.yaml --methods ekf,refined --out both\n"
      "  foucault evaluate short.rawlog --set outages.first_s=85 --set outages.length_s=15 \\\n"
      "      --set outages.period_s=45 --set outages.shifts_s=[0] --out short\n"
      "Outages come from the keys outages.* of the configuration; by default 60 s every 150 s "
      "after "
      "510 s,\nand again with starts 75 s later.");
  return [o](Call& call) { evaluate_logs(*o, call); };
}

}  // namespace foucault::app
