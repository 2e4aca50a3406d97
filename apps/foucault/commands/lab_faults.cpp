#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "arguments.h"
#include "commands/lab.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/export/text_file.h"
#include "jobs/laboratory_job.h"
#include "output_directory.h"

namespace foucault::app {
namespace {

using namespace laboratory;

struct FaultStudyOptions {
  FaultStudy study{{}, {"ekf", "refined", "full"}, {1}};
  StoreArguments store;
  int jobs = evaluation::processor_count();
  std::string out = "foucault-faults";
};

std::vector<std::string> all_faults() {
  std::vector<std::string> names;
  for (const FaultCase& fault : fault_cases()) names.push_back(fault.name);
  return names;
}

void write_outcomes(const std::vector<FaultOutcome>& outcomes,
                    const std::filesystem::path& folder) {
  exports::write_text_file(folder / "faults.csv", evaluation::to_csv(fault_table(outcomes)));
  exports::write_text_file(folder / "faults.md", evaluation::to_markdown(fault_summary(outcomes)));
}

void run_study(const FaultStudyOptions& options, RunStore& store, Call& call) {
  FaultStudy study = options.study;
  if (study.faults.empty()) study.faults = all_faults();
  OutputDirectory directory(options.out);
  const std::vector<FaultOutcome> outcomes =
      study_faults(study, store, directory.staging(), call.console);
  if (store.is_worker()) return;
  write_outcomes(outcomes, directory.staging());
  directory.commit();
  store.finish();
  call.console.say(written_lines(options.out, false));
}

}  // namespace

Study declare_fault_study(CLI::App& lab) {
  const auto o = std::make_shared<FaultStudyOptions>();
  CLI::App* faults = lab.add_subcommand(
      "faults", "What faults of recordings do to the methods, on simulated trips");
  faults->fallthrough();
  faults->add_option("--fault", o->study.faults, "Which ones, separated by commas; default: all")
      ->delimiter(',');
  faults->add_option("--methods", o->study.methods, "Separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  faults->add_option("--seeds", o->study.seeds, "Of the trips, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  add_jobs_option(*faults, o->jobs);
  add_output_option(*faults, o->out,
                    "Folder for faults.csv, a row a run, and faults.md, a row a fault")
      ->capture_default_str();
  add_store_options(*faults, o->store);
  faults->footer(
      "\nExamples:\n"
      "  foucault lab faults --out faults\n"
      "  foucault lab faults --fault ramp,spikes --methods ekf --seeds 1,2,3 --out faults");
  return {faults, [o](Call& call) {
            RunStore store(o->store, o->out, o->jobs);
            store.keep_if_stopped(call.console, [&] { run_study(*o, store, call); });
          }};
}

}  // namespace foucault::app
