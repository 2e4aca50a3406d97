#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "foucault/evaluation/drift_table.h"
#include "foucault/tuning/search.h"

/// What a search writes and says.
namespace foucault::tuning {

struct TuningResult {
  TuneConfig config;
  std::vector<MethodTuning> tunings;
  std::string base;  ///< its configuration, YAML
  std::string version;
};

/// Each pair of parameters once.
template <class Use>
void for_each_pair(const ParameterGrid& grid, Use use) {
  for (std::size_t x = 0; x < grid.axes.size(); ++x) {
    for (std::size_t y = x + 1; y < grid.axes.size(); ++y) use(x, y);
  }
}

/// METHOD_X_Y or METHOD_X, of letters, digits and '_' only.
std::string map_name(const std::string& method, const std::vector<std::string>& keys);

/// The chosen values of all methods.
evaluation::TextTable best_table(const TuningResult& result);

/// Where a wider grid might hold something better.
std::vector<std::string> edge_lines(const TuningResult& result);

/// best.yaml (best-METHOD.yaml for several methods), results.csv, points.csv (with the times of the
/// processor), metrics.json and heatmaps/METHOD_X_Y.csv for each pair of parameters. `config_at`
/// gives the configuration of a point as YAML.
void write_tuning(const TuningResult& result,
                  const std::function<std::string(const GridPoint&)>& config_at,
                  const std::filesystem::path& folder);

/// For the terminal; `folder` is where it was written.
std::vector<std::string> tuning_lines(const TuningResult& result,
                                      const std::filesystem::path& folder);

}  // namespace foucault::tuning
