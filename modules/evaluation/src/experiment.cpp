#include "foucault/evaluation/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "count_distinct.h"
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

const std::string& group_name(const ExperimentResult& result, Grouping grouping) {
  static const std::string all = "all recordings";
  if (grouping == Grouping::all) return all;
  return grouping == Grouping::imu ? result.imu : result.recording;
}

/// What outages of two methods must share to be the same.
using OutageKey = std::tuple<std::string, std::string, double, int64_t>;

OutageKey key(const MethodOutages::Entry& entry) {
  return {entry.run->imu, entry.run->recording, entry.run->shift_s, entry.drift->outage.index};
}

void append(MethodOutages& to, const ExperimentResult& result) {
  for (const OutageDrift& drift : result.run.drifts) to.entries.push_back({&result, &drift});
  to.missing +=
      std::max<int64_t>(0, result.run.scheduled - static_cast<int64_t>(result.run.drifts.size()));
  to.cpu_s += result.run.cpu_s;
}

/// Leaves the outages that all methods of each group have, in one order.
void keep_common(std::vector<MethodOutages>& outages) {
  std::map<std::string, std::map<OutageKey, std::size_t>> methods_with;
  std::map<std::string, std::size_t> methods_of;
  for (const MethodOutages& o : outages) {
    ++methods_of[o.group];
    for (const MethodOutages::Entry& entry : o.entries) ++methods_with[o.group][key(entry)];
  }
  for (MethodOutages& o : outages) {
    const auto& counts = methods_with[o.group];
    const auto lacking = [&](const MethodOutages::Entry& entry) {
      return counts.at(key(entry)) != methods_of.at(o.group);
    };
    o.entries.erase(std::remove_if(o.entries.begin(), o.entries.end(), lacking), o.entries.end());
    std::sort(o.entries.begin(), o.entries.end(),
              [](const auto& a, const auto& b) { return key(a) < key(b); });
  }
}

ExperimentResult without_results(const ExperimentRun& run) {
  return {run.recording, run.imu, run.method, run.shift_s, {}, {}, {}, {}, {}};
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

std::vector<double> maxima(const std::vector<MethodOutages::Entry>& entries,
                           double DriftValue::*component) {
  std::vector<double> values;
  for (const MethodOutages::Entry& entry : entries) {
    values.push_back(entry.drift->maximum.*component);
  }
  return values;
}

}  // namespace

ExperimentResult run_experiment(const ExperimentRun& run,
                                const std::function<void(double)>& progress) {
  RunWatcher watcher(progress);
  ExperimentResult result = without_results(run);
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
  experiment.named = [shared](std::size_t i) { return without_results((*shared)[i]); };
  experiment.set_batch([&](std::size_t i) { return (*shared)[i].depends_on; });
  return experiment;
}

ExperimentResult result_of(const Experiment& experiment, std::size_t index, Executor& executor) {
  const store::Record record = executor.get(experiment.batch, index);
  ExperimentResult result = with_content(experiment.named(index), record.content);
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

std::vector<std::string> take_out_failed(std::vector<ExperimentResult>& results) {
  std::vector<std::string> lines;
  std::set<std::string> failed;
  for (const ExperimentResult& result : results) {
    if (result.failure.empty()) continue;
    failed.insert(result.method);
    lines.push_back(fmt::format("method {}: {}", result.method, result.failure));
  }
  const auto has_failed = [&](const ExperimentResult& r) { return failed.count(r.method) > 0; };
  results.erase(std::remove_if(results.begin(), results.end(), has_failed), results.end());
  return lines;
}

std::vector<double> MethodOutages::horizontal_max() const {
  return maxima(entries, &DriftValue::horizontal);
}

std::vector<double> MethodOutages::vertical_max() const {
  return maxima(entries, &DriftValue::vertical);
}

std::vector<MethodOutages> group_outages(const std::vector<ExperimentResult>& results,
                                         Grouping grouping) {
  std::vector<std::string> groups;
  std::vector<MethodOutages> outages;
  for (const ExperimentResult& result : results) {
    const std::string& group = group_name(result, grouping);
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    const auto found = std::find_if(outages.begin(), outages.end(), [&](const MethodOutages& o) {
      return o.group == group && o.method == result.method;
    });
    if (found != outages.end()) {
      append(*found, result);
    } else {
      append(outages.emplace_back(MethodOutages{group, result.method, {}, 0, 0}), result);
    }
  }
  const auto place = [&](const MethodOutages& o) {
    return std::find(groups.begin(), groups.end(), o.group) - groups.begin();
  };
  std::stable_sort(outages.begin(), outages.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  keep_common(outages);
  return outages;
}

std::vector<MethodDrifts> method_drifts(const std::vector<MethodOutages>& outages) {
  std::vector<MethodDrifts> drifts;
  for (const MethodOutages& o : outages) {
    if (o.entries.empty()) continue;
    drifts.push_back({o.group, o.method, o.horizontal_max(), o.vertical_max()});
  }
  return drifts;
}

std::vector<DriftRecord> drift_records(const std::vector<ExperimentResult>& results) {
  std::vector<DriftRecord> records;
  for (const ExperimentResult& r : results) {
    for (const OutageDrift& drift : r.run.drifts) {
      records.push_back({r.recording, r.imu, r.method, r.shift_s, drift});
    }
  }
  return records;
}

std::vector<MethodOutages> table_rows(const std::vector<ExperimentResult>& results) {
  if (count_distinct(results, &ExperimentResult::imu) > 1) {
    return group_outages(results, Grouping::imu);
  }
  std::vector<MethodOutages> rows = group_outages(results, Grouping::recording);
  if (count_distinct(results, &ExperimentResult::recording) > 1) {
    const std::vector<MethodOutages> all = group_outages(results, Grouping::all);
    rows.insert(rows.end(), all.begin(), all.end());
  }
  return rows;
}

}  // namespace foucault::evaluation
