#include "point_scorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>

#include "evaluation_job.h"
#include "foucault/core/error.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/evaluation/task_pool.h"

namespace foucault::app {
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

class RunProgress : public OutageRunObserver {
 public:
  explicit RunProgress(const TaskProgress& progress) : progress_(progress) {}
  void progress(double part) override { progress_(part); }

 private:
  const TaskProgress& progress_;
};

RunScore score_run(const ExperimentRun& run, bool needs_outage, const TaskProgress& progress) {
  RunProgress observer(progress);
  RunScore score;
  OutageRunResult result;
  try {
    result = run_with_outages(run.open(), run.schedule, run.make_estimator, run.options, &observer);
  } catch (const DataError& error) {
    score.error = error.what();
    return score;
  }
  if (needs_outage) require_outage(run, result);
  score.scheduled = result.scheduled;
  score.cpu_s = result.cpu_s;
  for (const OutageDrift& drift : result.drifts) {
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
  score.horizontal_rms = valid ? root_mean_square(horizontal) : kInfinity;
  score.vertical_rms = valid ? root_mean_square(vertical) : kInfinity;
  return score;
}

double cpu_s(const std::vector<RunScore>& runs) {
  return std::accumulate(runs.begin(), runs.end(), 0.0,
                         [](double sum, const RunScore& run) { return sum + run.cpu_s; });
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

}  // namespace

PointScorer::PointScorer(const TuneJob& job, PointStore& store, Console& console)
    : job_(job), store_(store), console_(console) {}

std::vector<std::string> PointScorer::header(const ParameterGrid& grid) {
  std::vector<std::string> header{"method"};
  for (const GridAxis& axis : grid.axes) header.push_back(axis.key);
  for (const char* name : {"outages", "horizontal_rmse_m", "vertical_rmse_m", "cpu_s", "note"}) {
    header.push_back(name);
  }
  return header;
}

std::vector<std::string> PointScorer::key(const std::string& method, const GridPoint& point) const {
  std::vector<std::string> key{method};
  const ParameterGrid& grid = job_.config.grid;
  for (std::size_t a = 0; a < point.size(); ++a) key.push_back(grid.axes[a].values[point[a]]);
  return key;
}

std::vector<PointScore> PointScorer::scores(const std::string& method,
                                            const std::vector<GridPoint>& points) {
  std::vector<GridPoint> missing;
  for (const GridPoint& point : points) {
    if (!store_.find(key(method, point))) missing.push_back(point);
  }
  compute(method, missing);
  std::vector<PointScore> scores;
  for (const GridPoint& point : points)
    scores.push_back(score_of(*store_.find(key(method, point))));
  return scores;
}

void PointScorer::compute(const std::string& method, const std::vector<GridPoint>& points) {
  const std::vector<double>& shifts_s = job_.config.base.outages.shifts_s;
  const std::size_t shifts = shifts_s.size();
  const std::size_t first_shift = static_cast<std::size_t>(
      std::min_element(shifts_s.begin(), shifts_s.end()) - shifts_s.begin());
  const std::size_t runs_of_point = job_.logs.size() * shifts;
  std::vector<std::unique_ptr<OpenPoint>> open;
  for (std::size_t i = 0; i < points.size(); ++i) {
    open.push_back(std::make_unique<OpenPoint>(runs_of_point));
  }
  const auto task = [&](std::size_t index, const TaskProgress& progress) {
    const std::size_t p = index / runs_of_point;
    const std::size_t r = index % runs_of_point;
    const Settings settings = job_.config.at(points[p]);
    const std::string& log = job_.logs[r / shifts];
    const EvaluationCase run_case{log, log, settings.imu.preset, method, "", settings};
    const bool needs_outage = r % shifts == first_shift;
    RunScore score = score_run(experiment_runs(run_case)[r % shifts], needs_outage, progress);
    if (!open[p]->put(r, std::move(score))) return;
    PointScore finished = score_point(open[p]->runs());
    finished.note = one_line(finished.note);
    store_.add(key(method, points[p]), cells(finished, cpu_s(open[p]->runs())));
  };
  run_tasks(points.size() * runs_of_point, job_.threads, task, console_.progress_of(method));
}

}  // namespace foucault::app
