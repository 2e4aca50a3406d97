#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "commands/lab.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/export/text_file.h"
#include "jobs/laboratory_job.h"
#include "methods.h"
#include "output_directory.h"

namespace foucault::app {
namespace {

using namespace laboratory;

struct ReturnStudyOptions {
  std::vector<std::string> logs;  ///< empty: a simulated trip
  ConfigArguments config;
  std::vector<std::string> methods;
  std::vector<double> noise, lengths;
  int jobs = evaluation::processor_count();
  std::string out = "foucault-returns";
};

/// What is not given is swept on the simulated trip, and as configured on a recording.
ReturnStudyOptions completed(ReturnStudyOptions options, const Settings& settings) {
  const bool simulated = options.logs.empty();
  if (simulated) options.logs.emplace_back();
  if (options.noise.empty()) {
    options.noise = simulated ? std::vector<double>{0.1, 0.3, 1, 3, 10} : std::vector<double>{1};
  }
  if (options.lengths.empty()) {
    options.lengths = simulated ? std::vector<double>{5, 15, 30, 60, 120}
                                : std::vector<double>{settings.outages.length_s};
  }
  return options;
}

std::vector<laboratory::ReturnCase> return_cases(const ReturnStudyOptions& options) {
  for (const std::string& method : options.methods) methods::find(method);
  std::vector<laboratory::ReturnCase> cases;
  for (const std::string& log : options.logs) {
    for (const double noise : options.noise) {
      for (const double length_s : options.lengths) {
        for (const std::string& method : options.methods) {
          cases.push_back({log, noise, length_s, method});
        }
      }
    }
  }
  return cases;
}

void study_returns(const ReturnStudyOptions& given, Call& call) {
  Settings settings;
  apply(given.config, settings);
  const ReturnStudyOptions options = completed(given, settings);
  const std::vector<laboratory::ReturnCase> cases = return_cases(options);
  OutputDirectory directory(options.out);
  std::vector<laboratory::ReturnOutcome> outcomes(cases.size());
  evaluation::run_tasks(
      cases.size(), options.jobs,
      [&](std::size_t i, const evaluation::TaskProgress& progress) {
        progress(0);
        outcomes[i] = study_return(cases[i], settings);
      },
      call.console.progress_of("returns"));
  exports::write_text_file(directory.staging() / "returns.csv",
                           evaluation::to_csv(return_table(outcomes)));
  const std::string summary = evaluation::to_markdown(laboratory::return_summary(outcomes));
  exports::write_text_file(directory.staging() / "returns.md", summary);
  directory.commit();
  call.console.say(summary);
  call.console.say(written_lines(options.out, false));
}

}  // namespace

Study declare_return_study(CLI::App& lab) {
  const auto o = std::make_shared<ReturnStudyOptions>();
  CLI::App* returns = lab.add_subcommand(
      "returns",
      "Whether true fixes are believed after outages, whatever the noise model: against no gate");
  returns->fallthrough();
  for (const methods::Method& method : methods::all()) o->methods.push_back(method.name);
  add_input_option(*returns, "LOG", o->logs,
                   "Rawlogs, with the outages of the configuration; default: a "
                   "simulated trip");
  add_config_options(*returns, o->config, settings_help);
  returns->add_option("--methods", o->methods, "Separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  returns
      ->add_option("--noise", o->noise,
                   "What the noise of the IMU is configured by, times what it is, separated by "
                   "commas; default: 0.1 to 10, of a recording 1")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  returns
      ->add_option("--lengths", o->lengths,
                   "Of the outages [s], separated by commas; default: 5 to 120, of a recording "
                   "outages.length_s")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  add_jobs_option(*returns, o->jobs);
  add_output_option(*returns, o->out, "Folder for returns.csv, a row a run, and returns.md")
      ->capture_default_str();
  returns->footer(
      "\nExamples:\n"
      "  foucault lab returns --out returns\n"
      "  foucault lab returns trip.rawlog --lengths 20 --methods ekf,rts --out returns");
  return {returns, [o](Call& call) { study_returns(*o, call); }};
}

}  // namespace foucault::app
