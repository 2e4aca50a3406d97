#include "foucault/tuning/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "foucault/core/error.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/evaluation/task_pool.h"

namespace foucault::tuning {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What one run adds to the score of its point.
struct RunScore {
  std::vector<double> horizontal_max;
  std::vector<double> vertical_max;
  int64_t scheduled = 0;
  double cpu_s = 0;
  std::string error;
};

class RunProgress : public evaluation::OutageRunObserver {
 public:
  explicit RunProgress(const evaluation::TaskProgress& progress) : progress_(progress) {}
  void progress(double part) override { progress_(part); }

 private:
  const evaluation::TaskProgress& progress_;
};

RunScore score_run(const evaluation::ExperimentRun& run, bool needs_outage,
                   const evaluation::TaskProgress& progress) {
  RunProgress observer(progress);
  RunScore score;
  evaluation::OutageRunResult result;
  try {
    result = evaluation::run_with_outages(run.open(), run.schedule, run.make_estimator, run.options,
                                          &observer);
  } catch (const DataError& error) {
    score.error = error.what();
    return score;
  }
  if (needs_outage) evaluation::require_outage(run, result);
  score.scheduled = result.scheduled;
  score.cpu_s = result.cpu_s;
  for (const evaluation::OutageDrift& drift : result.drifts) {
    score.horizontal_max.push_back(drift.maximum.horizontal);
    score.vertical_max.push_back(drift.maximum.vertical);
  }
  return score;
}

void append(std::vector<double>& to, const std::vector<double>& values) {
  to.insert(to.end(), values.begin(), values.end());
}

/// Why a point has no drift that could be compared with those of others.
std::string flaw(const std::vector<RunScore>& runs, std::size_t outages) {
  int64_t scheduled = 0;
  for (const RunScore& run : runs) {
    if (!run.error.empty()) return run.error;
    scheduled += run.scheduled;
  }
  const int64_t missing = scheduled - static_cast<int64_t>(outages);
  if (missing <= 0) return "";
  return fmt::format("nothing to measure in {} of {} outages", missing, scheduled);
}

PointScore score_point(const std::vector<RunScore>& runs) {
  std::vector<double> horizontal;
  std::vector<double> vertical;
  for (const RunScore& run : runs) {
    append(horizontal, run.horizontal_max);
    append(vertical, run.vertical_max);
  }
  PointScore score;
  score.outages = static_cast<int64_t>(horizontal.size());
  score.note = flaw(runs, horizontal.size());
  const bool valid = score.note.empty() && !horizontal.empty();
  score.horizontal_rms = valid ? evaluation::root_mean_square(horizontal) : kInfinity;
  score.vertical_rms = valid ? evaluation::root_mean_square(vertical) : kInfinity;
  return score;
}

double cpu_s(const std::vector<RunScore>& runs) {
  double sum = 0;
  for (const RunScore& run : runs) sum += run.cpu_s;
  return sum;
}

/// Results as cells and back, without loss.
std::vector<std::string> cells(const PointScore& score, double cpu) {
  return {fmt::format("{}", score.outages), fmt::format("{}", score.horizontal_rms),
          fmt::format("{}", score.vertical_rms), fmt::format("{:.3f}", cpu), score.note};
}

template <class Number>
Number parsed(const std::string& cell) {
  Number value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    throw DataError(fmt::format("points.csv: '{}' is not a number; remove its line", cell));
  }
  return value;
}

PointScore score_of(const std::vector<std::string>& cells) {
  return {parsed<int64_t>(cells[0]), parsed<double>(cells[1]), parsed<double>(cells[2]), cells[4]};
}

/// One line, whatever a message holds: a line of the store is a point.
std::string one_line(std::string text) {
  for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
  return text;
}

/// A point while its runs are under way.
class OpenPoint {
 public:
  explicit OpenPoint(std::size_t runs) : runs_(runs), open_(runs) {}

  /// True if it was the last one.
  bool put(std::size_t index, RunScore score) {
    const std::lock_guard<std::mutex> lock(mutex_);
    runs_[index] = std::move(score);
    return --open_ == 0;
  }
  const std::vector<RunScore>& runs() const { return runs_; }

 private:
  std::mutex mutex_;
  std::vector<RunScore> runs_;
  std::size_t open_;
};

std::vector<std::string> key(const SearchPlan& plan, const std::string& method,
                             const GridPoint& point) {
  std::vector<std::string> key = plan.config.values(point);
  key.insert(key.begin(), method);
  return key;
}

/// A recording is too short if not even the outages of its least shift fit.
bool has_least_shift(const evaluation::ExperimentRun& run,
                     const std::vector<evaluation::ExperimentRun>& runs) {
  return std::all_of(runs.begin(), runs.end(), [&](const evaluation::ExperimentRun& other) {
    return run.shift_s <= other.shift_s;
  });
}

/// Runs as a task each; the last one of a point puts it into the store.
void compute(const SearchPlan& plan, const std::string& method,
             const std::vector<GridPoint>& points, PointStore& store) {
  const std::size_t runs_of_point = plan.logs.size() * plan.shifts;
  std::vector<std::unique_ptr<OpenPoint>> open;
  for (std::size_t i = 0; i < points.size(); ++i) {
    open.push_back(std::make_unique<OpenPoint>(runs_of_point));
  }
  const auto task = [&](std::size_t index, const evaluation::TaskProgress& progress) {
    const std::size_t p = index / runs_of_point;
    const std::size_t r = index % runs_of_point;
    const std::vector<evaluation::ExperimentRun> runs =
        plan.runs(plan.logs[r / plan.shifts], method, points[p]);
    const evaluation::ExperimentRun& run = runs[r % plan.shifts];
    if (!open[p]->put(r, score_run(run, has_least_shift(run, runs), progress))) return;
    PointScore finished = score_point(open[p]->runs());
    finished.note = one_line(finished.note);
    store.add(key(plan, method, points[p]), cells(finished, cpu_s(open[p]->runs())));
  };
  evaluation::run_tasks(points.size() * runs_of_point, plan.threads, task,
                        plan.progress_of(method));
}

/// In the order of `points`; those that are in the store already are not computed again.
std::vector<PointScore> scores(const SearchPlan& plan, const std::string& method,
                               const std::vector<GridPoint>& points, PointStore& store) {
  std::vector<GridPoint> missing;
  for (const GridPoint& point : points) {
    if (!store.find(key(plan, method, point))) missing.push_back(point);
  }
  compute(plan, method, missing, store);
  std::vector<PointScore> scores;
  for (const GridPoint& point : points) {
    scores.push_back(score_of(*store.find(key(plan, method, point))));
  }
  return scores;
}

std::string grid_text(const ParameterGrid& grid) {
  std::string text;
  for (const GridAxis& axis : grid.axes) {
    text += axis.key + "\n";
    for (const std::string& value : axis.values) text += "  " + value + "\n";
  }
  return text;
}

}  // namespace

PointStore open_points(const std::string& path, const SearchPlan& plan, const std::string& base,
                       const std::string& version) {
  const ParameterGrid& grid = plan.config.grid;
  std::string logs;
  for (const std::string& log : plan.logs) logs += hash_file(log);
  std::vector<std::string> header{"method"};
  for (const GridAxis& axis : grid.axes) header.push_back(axis.key);
  const std::size_t keys = header.size();
  for (const char* name : {"outages", "horizontal_rmse_m", "vertical_rmse_m", "cpu_s", "note"}) {
    header.push_back(name);
  }
  return PointStore(path,
                    {{"logs", hash_text(logs)},
                     {"base configuration", hash_text(base)},
                     {"grid", hash_text(grid_text(grid))},
                     {"program version", version}},
                    header, keys);
}

MethodTuning search(const SearchPlan& plan, const std::string& method, PointStore& store) {
  const TuneOptions& options = plan.config.options;
  MethodTuning tuning;
  tuning.method = method;
  const BatchObjective objective = [&](const std::vector<GridPoint>& points) {
    const std::vector<PointScore> found = scores(plan, method, points, store);
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); ++i) {
      tuning.scores[points[i]] = found[i];
      values.push_back(options.objective_of(found[i].horizontal_rms, found[i].vertical_rms));
    }
    return values;
  };
  const ParameterGrid& grid = plan.config.grid;
  tuning.search = options.search == "full" ? full_search(grid, objective)
                                           : coarse_to_fine_search(grid, objective);
  if (!std::isfinite(tuning.search.value)) {
    throw DataError(fmt::format("{}: no point of the grid gave a drift; the first: {}", method,
                                tuning.scores.begin()->second.note));
  }
  return tuning;
}

}  // namespace foucault::tuning
