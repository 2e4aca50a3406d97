#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "foucault/evaluation/experiment.h"
#include "foucault/tuning/tune_config.h"

/// A search over recordings. It knows estimators and recordings by a factory of runs alone.
namespace foucault::tuning {

struct SearchPlan {
  TuneConfig config;
  std::vector<std::string> logs;
  std::size_t shifts = 1;  ///< of the outages: as many runs a log
  /// The runs of a method on a log with the configuration of a point, one a shift, with all that
  /// they depend on, and the log for the name of the recording; from any thread.
  std::function<std::vector<evaluation::ExperimentRun>(
      const std::string& log, const std::string& method, const GridPoint& point)>
      runs;
  /// Takes the part done of a method.
  std::function<std::function<void(double)>(const std::string& method)> progress_of;
};

/// How good a point of the grid is, over all outages of all logs and shifts.
struct PointScore {
  int64_t outages = 0;
  double horizontal_rms = 0;  ///< of the per-outage maximum [m]; infinite if an outage is missing
  double vertical_rms = 0;    ///< [m]
  double cpu_s = 0;           ///< of all runs
  std::string note;           ///< why there is no drift; empty: there is one
};

/// What was found for one method.
struct MethodTuning {
  std::string method;
  GridSearchResult search;
  std::map<GridPoint, PointScore> scores;  ///< of every point that was evaluated

  const PointScore& best() const { return scores.at(search.best); }
};

/// Searches the grid for a method, runs in parallel; those that are in the store of the executor
/// are not computed again. Every worker that searches takes the same steps. A point of which a run
/// fails has a note and infinite drifts. Throws DataError if no point gives a drift or no outage
/// fits into a log, and what executor and progress throw.
MethodTuning search(const SearchPlan& plan, const std::string& method,
                    evaluation::Executor& executor);

}  // namespace foucault::tuning
