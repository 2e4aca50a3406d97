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

struct FaultStudyOptions {
  std::vector<std::string> faults;
  std::vector<std::string> methods{"ekf", "refined", "full"};
  std::vector<int64_t> seeds{1};
  int jobs = evaluation::processor_count();
  std::string out = "foucault-faults";
};

struct FaultTask {
  std::string fault;
  int64_t seed;
};

std::vector<FaultTask> fault_tasks(const FaultStudyOptions& options) {
  std::vector<std::string> names = options.faults;
  if (names.empty()) {
    for (const laboratory::FaultCase& fault : laboratory::fault_cases())
      names.push_back(fault.name);
  }
  for (const std::string& method : options.methods) methods::find(method);
  std::vector<FaultTask> tasks;
  for (const std::string& name : names) {
    laboratory::find_fault_case(name);
    for (const int64_t seed : options.seeds) tasks.push_back({name, seed});
  }
  return tasks;
}

void study_faults(const FaultStudyOptions& options, Call& call) {
  const std::vector<FaultTask> tasks = fault_tasks(options);
  OutputDirectory directory(options.out);
  std::vector<std::vector<laboratory::FaultOutcome>> results(tasks.size());
  evaluation::run_tasks(
      tasks.size(), options.jobs,
      [&](std::size_t i, const evaluation::TaskProgress& progress) {
        progress(0);
        const FaultTask& task = tasks[i];
        const std::filesystem::path log =
            directory.staging() / fmt::format("{}-{}.rawlog", task.fault, task.seed);
        results[i] = run_fault(laboratory::find_fault_case(task.fault), options.methods, Settings(),
                               task.seed, log.string());
      },
      call.console.progress_of("faults"));
  std::vector<laboratory::FaultOutcome> outcomes;
  for (const auto& result : results) {
    outcomes.insert(outcomes.end(), result.begin(), result.end());
  }
  exports::write_text_file(directory.staging() / "faults.csv",
                           evaluation::to_csv(laboratory::fault_table(outcomes)));
  exports::write_text_file(directory.staging() / "faults.md",
                           evaluation::to_markdown(laboratory::fault_summary(outcomes)));
  directory.commit();
  call.console.say(written_lines(options.out, false));
}

}  // namespace

Study declare_fault_study(CLI::App& lab) {
  const auto o = std::make_shared<FaultStudyOptions>();
  CLI::App* faults = lab.add_subcommand(
      "faults", "What faults of recordings do to the methods, on simulated trips");
  faults->fallthrough();
  faults->add_option("--fault", o->faults, "Which ones, separated by commas; default: all")
      ->delimiter(',');
  faults->add_option("--methods", o->methods, "Separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  faults->add_option("--seeds", o->seeds, "Of the trips, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  add_jobs_option(*faults, o->jobs);
  add_output_option(*faults, o->out,
                    "Folder for faults.csv, a row a run, and faults.md, a row a fault")
      ->capture_default_str();
  faults->footer(
      "\nExamples:\n"
      "  foucault lab faults --out faults\n"
      "  foucault lab faults --fault ramp,spikes --methods ekf --seeds 1,2,3 --out faults");
  return {faults, [o](Call& call) { study_faults(*o, call); }};
}

}  // namespace foucault::app
