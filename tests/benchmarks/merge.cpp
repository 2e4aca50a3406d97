/// Makes a store of so many synthetic runs, or merges it as `foucault evaluate` does, and says what
/// that took.
///   foucault_merge_benchmark fill|merge RUNS FOLDER
/// Two methods on recordings with five shifts each; a run has three outages of 40 samples.

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <exception>
#include <filesystem>
#include <string>

#include "foucault/store/record_store.h"
#include "jobs/evaluation_job.h"
#include "support/drifting_estimator.h"

/// Synthetic records need not outlive the machine; syncs would be nearly all of the time to make
/// them.
extern "C" int fsync(int) { return 0; }

namespace foucault::benchmarks {
namespace {

constexpr std::size_t kMethods = 2, kShifts = 5;

evaluation::RunName name_of(std::size_t run) {
  const std::size_t shift = run / kMethods % kShifts;
  return {fmt::format("recording-{:06}", run / kMethods / kShifts), "none",
          run % kMethods == 0 ? "good" : "bad", static_cast<double>(shift)};
}

evaluation::ExperimentRun run_of(std::size_t index) {
  evaluation::OutageOptions outages;
  outages.first_s = 12;
  outages.length_s = 10;
  outages.period_s = 20;
  evaluation::ExperimentRun run;
  const evaluation::RunName name = name_of(index);
  run.recording = name.recording;
  run.imu = name.imu;
  run.method = name.method;
  run.shift_s = name.shift_s;
  run.schedule = evaluation::OutageSchedule(outages, run.shift_s);
  run.with_track = index < 6 * kMethods * kShifts;
  run.open = [] { return std::make_unique<test::RestSource>(75, true); };
  const double scale = 1 + static_cast<double>(index % 1000) / 1000;
  run.make_estimator = [scale](const state::Mounting&, state::Sink& sink) {
    return std::make_unique<test::DriftingEstimator>(sink, scale);
  };
  return run;
}

evaluation::Experiment experiment_of(std::size_t runs) {
  evaluation::Experiment experiment;
  experiment.size = runs;
  experiment.run = run_of;
  experiment.name = name_of;
  experiment.set_batch([](std::size_t i) { return fmt::format("synthetic {}", i); });
  return experiment;
}

void merge(const evaluation::Experiment& experiment, evaluation::Executor& executor,
           const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  app::Console console(true);
  executor.complete(experiment.batch);
  const app::Evaluation evaluation = app::gather(experiment, {}, executor, folder, console);
  app::EvaluationLabels labels;
  app::write_evaluation(evaluation, labels, true, folder, console);
}

void measure(const std::string& what, std::size_t runs, const std::filesystem::path& folder) {
  const auto begin = std::chrono::steady_clock::now();
  const evaluation::Experiment experiment = experiment_of(runs);
  store::RecordStore store((folder / "store").string());
  const bool fills = what == "fill";
  evaluation::Executor executor(store, {evaluation::processor_count(), std::nullopt, fills});
  if (fills) {
    executor.complete(experiment.batch);
  } else {
    merge(experiment, executor, folder / "out");
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("{} of {} runs: {:.1f} s, {} MB\n", what, runs, took.count(), usage.ru_maxrss / 1000);
}

}  // namespace
}  // namespace foucault::benchmarks

int main(int argc, char** argv) {
  const std::string what = argc == 4 ? argv[1] : "";
  if (what != "fill" && what != "merge") {
    fmt::print(stderr, "foucault_merge_benchmark fill|merge RUNS FOLDER\n");
    return 2;
  }
  try {
    foucault::benchmarks::measure(what, std::stoul(argv[2]), argv[3]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "foucault_merge_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
