#pragma once

#include <map>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/evaluation/grid_search.h"
#include "tune_config.h"

namespace foucault::app {

struct TuneJob {
  std::vector<std::string> logs;
  TuneConfig config;
  std::string out;  ///< folder
  int threads = 1;
  bool report = true;
  std::string command_line;
};

/// How good a point of the grid is, over all outages of all logs and shifts.
struct PointScore {
  int64_t outages = 0;
  double horizontal_rms = 0;  ///< of the per-outage maximum [m]; infinite if an outage is missing
  double vertical_rms = 0;    ///< [m]
  std::string note;           ///< why there is no drift; empty: there is one
};

/// What was found for one method.
struct MethodTuning {
  std::string method;
  GridSearchResult search;
  std::map<GridPoint, PointScore> scores;  ///< of every point that was evaluated
};

/// Searches the grid for each method. Every finished point is kept in out/points.csv at once: the
/// same command goes on from there after a kill, and ends with the same result.
/// Throws DataError, UsageError, Interrupted.
std::vector<MethodTuning> search(const TuneJob& job, Console& console);

/// Searches and writes best.yaml (best-METHOD.yaml for several), results.csv, metrics.json,
/// heatmaps/ and report/ to job.out: all of it or nothing. Returns what to tell the user.
std::vector<std::string> tune(const TuneJob& job, Console& console);

}  // namespace foucault::app
