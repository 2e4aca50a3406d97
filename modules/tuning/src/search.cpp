#include "foucault/tuning/search.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/evaluation/statistics.h"

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

RunScore score_run(const evaluation::ExperimentResult& result) {
  RunScore score;
  score.error = result.remarks.damage.value_or(result.failure);
  score.scheduled = result.run.scheduled;
  score.cpu_s = result.run.cpu_s;
  for (const evaluation::OutageDrift& drift : result.run.drifts) {
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

/// One line, whatever a message holds: a line of a table is a point.
std::string one_line(std::string text) {
  for (char& c : text) c = c == '\n' || c == '\r' ? ' ' : c;
  return text;
}

PointScore score_point(const std::vector<RunScore>& runs) {
  std::vector<double> horizontal;
  std::vector<double> vertical;
  PointScore score;
  for (const RunScore& run : runs) {
    append(horizontal, run.horizontal_max);
    append(vertical, run.vertical_max);
    score.cpu_s += run.cpu_s;
  }
  score.outages = static_cast<int64_t>(horizontal.size());
  score.note = one_line(flaw(runs, horizontal.size()));
  const bool valid = score.note.empty() && !horizontal.empty();
  score.horizontal_rms = valid ? evaluation::root_mean_square(horizontal) : kInfinity;
  score.vertical_rms = valid ? evaluation::root_mean_square(vertical) : kInfinity;
  return score;
}

/// The runs of points, all those on one log beside each other.
class PointRuns {
 public:
  PointRuns(const SearchPlan& plan, const std::string& method, const std::vector<GridPoint>& points)
      : plan_(plan), method_(method), points_(points) {}

  std::size_t size() const { return plan_.logs.size() * points_.size() * plan_.shifts; }

  evaluation::ExperimentRun run(std::size_t index) const {
    return runs(index / plan_.shifts).at(index % plan_.shifts);
  }

  /// The log is the name of the recording.
  evaluation::RunName name(std::size_t index) const {
    return {plan_.logs[index / plan_.shifts / points_.size()], "", method_, 0};
  }

  /// Asked in the order of runs; those of the shifts are made together.
  std::string depends_on(std::size_t index) {
    if (index % plan_.shifts == 0) last_ = runs(index / plan_.shifts);
    return last_.at(index % plan_.shifts).depends_on;
  }

  /// Of a point, in the order of logs and shifts.
  std::vector<std::size_t> of_point(std::size_t point) const {
    std::vector<std::size_t> indices;
    for (std::size_t log = 0; log < plan_.logs.size(); ++log) {
      for (std::size_t shift = 0; shift < plan_.shifts; ++shift) {
        indices.push_back((log * points_.size() + point) * plan_.shifts + shift);
      }
    }
    return indices;
  }

 private:
  std::vector<evaluation::ExperimentRun> runs(std::size_t log_and_point) const {
    return plan_.runs(plan_.logs[log_and_point / points_.size()], method_,
                      points_[log_and_point % points_.size()]);
  }

  const SearchPlan& plan_;
  const std::string& method_;
  const std::vector<GridPoint>& points_;
  std::vector<evaluation::ExperimentRun> last_;
};

/// In the order of `points`.
std::vector<PointScore> scores(const SearchPlan& plan, const std::string& method,
                               const std::vector<GridPoint>& points,
                               evaluation::Executor& executor) {
  PointRuns runs(plan, method, points);
  evaluation::Experiment experiment;
  experiment.size = runs.size();
  experiment.run = [&](std::size_t i) { return runs.run(i); };
  experiment.name = [&](std::size_t i) { return runs.name(i); };
  experiment.set_batch([&](std::size_t i) { return runs.depends_on(i); });
  executor.complete(experiment.batch, plan.progress_of(method));
  std::vector<PointScore> scores;
  for (std::size_t p = 0; p < points.size(); ++p) {
    std::vector<RunScore> of_point;
    for (const std::size_t i : runs.of_point(p)) {
      of_point.push_back(score_run(evaluation::result_of(experiment, i, executor)));
    }
    scores.push_back(score_point(of_point));
  }
  return scores;
}

}  // namespace

MethodTuning search(const SearchPlan& plan, const std::string& method,
                    evaluation::Executor& executor) {
  const TuneOptions& options = plan.config.options;
  MethodTuning tuning;
  tuning.method = method;
  const BatchObjective objective = [&](const std::vector<GridPoint>& points) {
    const std::vector<PointScore> found = scores(plan, method, points, executor);
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
