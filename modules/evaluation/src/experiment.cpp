#include "foucault/evaluation/experiment.h"

#include <fmt/format.h>

#include <utility>

#include "experiment_record.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

constexpr std::size_t kMostNotices = 100;

/// What of a run is wanted beside its drifts.
class RunWatcher : public OutageRunObserver {
 public:
  explicit RunWatcher(const std::function<void(double)>& progress) : progress_(progress) {}

  void notice(const state::Notice& notice) override {
    if (notices_.size() < kMostNotices) notices_.push_back(notice);
  }
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error) override {
    by_reference_.add(epoch, error.position_n);
  }
  void withheld_error(const Outage&, const state::Epoch& epoch,
                      const Eigen::Vector3d& error_n) override {
    by_fixes_.add(epoch, error_n);
  }
  void progress(double part) override {
    if (progress_) progress_(part);
  }

  const std::vector<TrackPoint>& track(DriftTruth truth) const {
    return (truth == DriftTruth::reference ? by_reference_ : by_fixes_).points();
  }
  const std::vector<state::Notice>& notices() const { return notices_; }

 private:
  const std::function<void(double)>& progress_;
  ErrorTrack by_reference_;
  ErrorTrack by_fixes_;
  std::vector<state::Notice> notices_;
};

RunName name_of(const ExperimentRun& run) {
  return {run.recording, run.imu, run.method, run.shift_s};
}

void require_outage(const ExperimentRun& run, const ExperimentResult& result) {
  if (!run.needs_outage || !result.failure.empty() || result.run.scheduled > 0) return;
  const double span_s = seconds_between(result.run.first_fix_ns, result.run.last_fix_ns);
  throw DataError(fmt::format(
      "{}: no outage fits into its {:.0f} s of fixes, the first would end after {:.0f} s; lower "
      "outages.first_s or outages.length_s, or give outages.starts_s",
      run.recording, span_s, run.schedule.first_end_s().value_or(0)));
}

store::Record record_of(const ExperimentRun& run, const TaskProgress& progress) {
  const ExperimentResult result = run_experiment(run, progress);
  return {content_of(result), result.run.cpu_s};
}

}  // namespace

ExperimentResult run_experiment(const ExperimentRun& run,
                                const std::function<void(double)>& progress) {
  RunWatcher watcher(progress);
  ExperimentResult result{name_of(run), {}, {}, {}, {}, {}};
  try {
    result.run =
        run_with_outages(run.open(), run.schedule, run.make_estimator, run.options, &watcher);
  } catch (const EstimatorFailure& failure) {
    result.failure = failure.what();
    return result;
  }
  if (run.with_track) result.track = watcher.track(result.run.truth);
  result.notices = watcher.notices();
  if (run.remarks) result.remarks = *run.remarks;
  require_outage(run, result);
  return result;
}

void Experiment::set_batch(const std::function<std::string(std::size_t)>& depends_on) {
  batch.keys.clear();
  batch.keys.reserve(size);
  for (std::size_t i = 0; i < size; ++i) batch.keys.push_back(store::key_of(depends_on(i)));
  batch.compute = [make = run](std::size_t i, const TaskProgress& progress) {
    return record_of(make(i), progress);
  };
}

Experiment experiment(std::vector<ExperimentRun> runs) {
  const auto shared = std::make_shared<const std::vector<ExperimentRun>>(std::move(runs));
  Experiment experiment;
  experiment.size = shared->size();
  experiment.run = [shared](std::size_t i) { return (*shared)[i]; };
  experiment.name = [shared](std::size_t i) { return name_of((*shared)[i]); };
  experiment.set_batch([&](std::size_t i) { return (*shared)[i].depends_on; });
  return experiment;
}

ExperimentResult result_of(const Experiment& experiment, std::size_t index, Executor& executor) {
  const store::Record record = executor.get(experiment.batch, index);
  ExperimentResult result = result_with(experiment.name(index), record.content);
  result.run.cpu_s = record.cpu_s;
  if (result.run.scheduled == 0) require_outage(experiment.run(index), result);
  return result;
}

std::vector<ExperimentResult> run_experiments(const std::vector<ExperimentRun>& runs, int threads,
                                              const std::function<void(double)>& progress) {
  std::vector<ExperimentRun> numbered = runs;
  for (std::size_t i = 0; i < runs.size(); ++i) numbered[i].depends_on = fmt::format("{}", i);
  const Experiment all = experiment(std::move(numbered));
  store::MemoryRecords records;
  Executor executor(records, {threads, std::nullopt, true});
  executor.complete(all.batch, progress);
  std::vector<ExperimentResult> results;
  for (std::size_t i = 0; i < all.size; ++i) results.push_back(result_of(all, i, executor));
  return results;
}

std::vector<DriftRecord> drift_records(const ExperimentResult& result) {
  std::vector<DriftRecord> records;
  for (const OutageDrift& drift : result.run.drifts) {
    records.push_back({result.recording, result.imu, result.method, result.shift_s, drift});
  }
  return records;
}

}  // namespace foucault::evaluation
