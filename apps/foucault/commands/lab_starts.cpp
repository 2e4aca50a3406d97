#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.h"
#include "commands/lab.h"
#include "foucault/evaluation/task_pool.h"
#include "foucault/export/text_file.h"
#include "jobs/laboratory_job.h"
#include "output_directory.h"

namespace foucault::app {
namespace {

struct StartStudyOptions {
  ConfigArguments config;
  int64_t seed = 1;
  int64_t count = 200;
  int jobs = evaluation::processor_count();
  std::string out = "foucault-starts";
};

void study_starts(const StartStudyOptions& options, Call& call) {
  Settings settings;
  apply(options.config, settings);
  OutputDirectory directory(options.out);
  std::vector<laboratory::StartOutcome> outcomes(static_cast<std::size_t>(options.count));
  evaluation::run_tasks(
      outcomes.size(), options.jobs,
      [&](std::size_t i, const evaluation::TaskProgress& progress) {
        progress(0);
        outcomes[i] = study_start(options.seed + static_cast<int64_t>(i), settings);
      },
      call.console.progress_of("starts"));
  exports::write_text_file(directory.staging() / "starts.csv",
                           evaluation::to_csv(laboratory::start_table(outcomes)));
  const std::string summary = evaluation::to_markdown(laboratory::start_summary(outcomes));
  exports::write_text_file(directory.staging() / "starts.md", summary);
  directory.commit();
  call.console.say(summary);
  call.console.say(written_lines(options.out, false));
}

}  // namespace

Study declare_start_study(CLI::App& lab) {
  const auto o = std::make_shared<StartStudyOptions>();
  CLI::App* starts = lab.add_subcommand(
      "starts",
      "Whether runs find into recordings that begin anywhere: random vehicles, receivers and IMUs, "
      "at rest, in motion and turning, beside a filter that is told the truth");
  starts->fallthrough();
  add_config_options(*starts, o->config, settings_help);
  starts->add_option("--seed", o->seed, "Of the first start; each has the next one")
      ->capture_default_str();
  starts->add_option("--count", o->count, "How many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_jobs_option(*starts, o->jobs);
  add_output_option(*starts, o->out, "Folder for starts.csv, a row a start, and starts.md")
      ->capture_default_str();
  starts->footer(
      "\nExamples:\n"
      "  foucault lab starts --count 50 --out starts\n"
      "  foucault lab starts --seed 7 --count 1 --out start");
  return {starts, [o](Call& call) { study_starts(*o, call); }};
}

}  // namespace foucault::app
