#pragma once

#include <string>
#include <vector>

#include "console.h"
#include "foucault/tuning/search.h"
#include "jobs/run_store.h"
#include "settings.h"

namespace foucault::app {

struct TuneJob {
  std::vector<std::string> logs;
  Settings base;
  tuning::TuneConfig config;
  std::string out;  ///< folder
  bool report = true;
  std::string command_line;

  /// The base with the values of a point.
  Settings at(const tuning::GridPoint& point) const;
};

/// Reads the file of a search into base and config, or its text; `assignments` (key=value) change
/// the base. Throws as tuning::load_tune_config does.
void load_grid(const std::string& path, const std::vector<std::string>& assignments, TuneJob& job);
void load_grid_text(const std::string& yaml, const std::string& origin,
                    const std::vector<std::string>& assignments, TuneJob& job);

/// Searches the grid for each method. Every finished run is kept in the store at once: the same
/// command goes on from there after a kill, and ends with the same result.
/// Throws DataError, UsageError, Interrupted.
std::vector<tuning::MethodTuning> search(const TuneJob& job, RunStore& store, Console& console);

/// Searches and writes best.yaml (best-METHOD.yaml for several), results.csv, points.csv,
/// metrics.json, heatmaps/ and report/ to job.out: all of it or nothing; a worker writes nothing.
/// Returns what to tell the user.
std::vector<std::string> tune(const TuneJob& job, RunStore& store, Console& console);

}  // namespace foucault::app
