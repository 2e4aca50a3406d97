#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "arguments.h"
#include "command.h"
#include "foucault/evaluation/task_pool.h"
#include "jobs/demo_job.h"
#include "output_directory.h"
#include "version.h"

namespace foucault::app {
namespace {

using laboratory::PaperExperiment;

struct DemoOptions {
  bool full = false;
  int jobs = evaluation::processor_count();
  std::string out = "foucault-demo";
};

PaperExperiment experiment_of(const DemoOptions& options) {
  if (options.full) return {{2325, 1617, 2333}};
  return {{1617}};
}

/// Where the reports of a demo are, and what they are called.
constexpr std::array<std::pair<const char*, const char*>, 3> kPages{{
    {"report", "The paper's experiment, noise as simulated"},
    {"tuned/report", "The paper's experiment, noise tuned for each method"},
    {"trip/report", "One trip from recording to report"},
}};

/// From one of the pages to the others.
std::vector<page::Link> links_from(std::string_view page) {
  std::vector<page::Link> links;
  for (const auto& [other, title] : kPages) {
    if (other == page) continue;
    const std::filesystem::path target = std::filesystem::path(other).lexically_relative(page);
    links.push_back({title, (target / "index.html").generic_string()});
  }
  return links;
}

void evaluate_into(const std::vector<EvaluationCase>& cases, const EvaluationLabels& labels,
                   RunStore& store, const std::filesystem::path& folder, Console& console) {
  std::filesystem::create_directories(folder);
  const Evaluation evaluation{evaluate(cases, store, folder, console)};
  write_evaluation(evaluation, labels, true, folder, console);
  console.say("");
  console.say(labels.title);
  console.say(evaluation::evaluation_lines(*evaluation.summary));
}

void main_job(const PaperExperiment& experiment, const std::filesystem::path& recordings,
              const std::filesystem::path& folder, Call& call) {
  RunJob job = demo_run(experiment, recordings);
  job.out = folder.string();
  job.command_line = call.command_line;
  job.links = links_from(kPages[2].first);
  std::filesystem::create_directories(folder);
  const RunResult result = run_into(job, folder, call.console);
  call.console.say(
      fmt::format("One trip with an {} processed by {}", job.settings.imu.preset, job.method));
  for (const std::string& line : summary_lines(result)) {
    const bool names_staging = line.find(folder.string()) != std::string::npos;
    if (!names_staging) call.console.say(line);
  }
}

void run_demo(const DemoOptions& options, RunStore& store, Call& call) {
  OutputDirectory directory(options.out);
  const std::filesystem::path folder = directory.staging();
  const std::filesystem::path recordings = folder / "recordings";
  const PaperExperiment experiment = experiment_of(options);

  call.console.say(fmt::format("simulating {} recordings: {} trip{} with {} IMUs",
                               experiment.trips_s.size() * laboratory::paper_imus().size(),
                               experiment.trips_s.size(), experiment.trips_s.size() == 1 ? "" : "s",
                               laboratory::paper_imus().size()));
  write_demo_recordings(experiment, recordings, call.console);
  main_job(experiment, recordings, folder / "trip", call);

  EvaluationLabels labels;
  labels.origin = {call.command_line, "", kVersion};
  labels.title = kPages[0].second;
  labels.links = links_from(kPages[0].first);
  labels.remarks = laboratory::remarks_as_simulated();
  evaluate_into(evaluation_cases(laboratory::cases_as_simulated(experiment), recordings), labels,
                store, folder, call.console);
  labels.title = kPages[1].second;
  labels.links = links_from(kPages[1].first);
  labels.remarks = laboratory::remarks_tuned();
  evaluate_into(evaluation_cases(laboratory::cases_tuned(experiment), recordings), labels, store,
                folder / "tuned", call.console);
  directory.commit();
  store.finish();

  const std::filesystem::path out = options.out;
  call.console.say("");
  call.console.say(fmt::format("{:<10} {}", "written", options.out));
  for (const auto& [page, title] : kPages)
    call.console.say(fmt::format("{:<10} {}", "report", (out / page / "index.html").string()));
}

}  // namespace

std::function<void(Call&)> declare_demo(CLI::App& app) {
  const auto o = std::make_shared<DemoOptions>();
  app.add_flag("--full", o->full, "The paper's three trips, 2325, 1617 and 2333 s, instead of one");
  add_jobs_option(app, o->jobs);
  add_output_option(app, o->out, "Folder for recordings, solution, tables and reports")
      ->capture_default_str();
  app.footer(
      "\nSimulates a car with the four IMUs of the paper, smooths one trip from recording to\n"
      "report (DIR/trip), then withholds GNSS for 60 s every 150 s and compares the drift of ekf,\n"
      "refined and rough: Tables III and IV, with the noise that was simulated (DIR/report) and\n"
      "with noise tuned for each method (DIR/tuned/report).\n"
      "\nExamples:\n"
      "  foucault demo\n"
      "  foucault demo --full --jobs 4 --out paper");
  return [o](Call& call) {
    RunStore store({}, o->out, o->jobs);
    store.keep_if_stopped(call.console, [&] { run_demo(*o, store, call); });
  };
}

}  // namespace foucault::app
