#include "foucault/tuning/tuning_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "foucault/export/json_object.h"
#include "foucault/export/text_file.h"

namespace foucault::tuning {
namespace {

using exports::Json;
using exports::Object;

std::string finite_text(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

/// Every evaluated point, in the order of the grid.
evaluation::TextTable results_table(const TuningResult& result) {
  evaluation::TextTable table;
  table.header.push_back("method");
  for (const GridAxis& axis : result.config.grid.axes) table.header.push_back(axis.key);
  for (const char* name :
       {"outages", "horizontal_rmse_m", "vertical_rmse_m", "objective_m", "best", "note"}) {
    table.header.push_back(name);
  }
  for (const MethodTuning& tuning : result.tunings) {
    for (const auto& [point, score] : tuning.scores) {
      std::vector<std::string> row = result.config.values(point);
      row.insert(row.begin(), tuning.method);
      row.insert(row.end(),
                 {fmt::format("{}", score.outages), finite_text(score.horizontal_rms),
                  finite_text(score.vertical_rms), finite_text(tuning.search.evaluated.at(point)),
                  point == tuning.search.best ? "1" : "0", score.note});
      table.rows.push_back(row);
    }
  }
  return table;
}

/// What each evaluated point came to, and took.
evaluation::TextTable points_table(const TuningResult& result) {
  evaluation::TextTable table;
  table.header.push_back("method");
  for (const GridAxis& axis : result.config.grid.axes) table.header.push_back(axis.key);
  for (const char* name : {"outages", "horizontal_rmse_m", "vertical_rmse_m", "cpu_s", "note"}) {
    table.header.push_back(name);
  }
  for (const MethodTuning& tuning : result.tunings) {
    for (const auto& [point, score] : tuning.scores) {
      std::vector<std::string> row = result.config.values(point);
      row.insert(row.begin(), tuning.method);
      row.insert(
          row.end(),
          {fmt::format("{}", score.outages), fmt::format("{}", score.horizontal_rms),
           fmt::format("{}", score.vertical_rms), fmt::format("{:.3f}", score.cpu_s), score.note});
      table.rows.push_back(row);
    }
  }
  return table;
}

Json tuning_json(const TuneConfig& config, const MethodTuning& tuning) {
  const std::vector<std::string> values = config.values(tuning.search.best);
  Json parameters = Json::object();
  for (std::size_t a = 0; a < values.size(); ++a) parameters[config.grid.axes[a].key] = values[a];
  return Object()
      .with("outages", tuning.best().outages)
      .with("horizontal_rmse_m", tuning.best().horizontal_rms)
      .with("vertical_rmse_m", tuning.best().vertical_rms)
      .with("objective_m", tuning.search.value)
      .with("parameters", parameters)
      .with("evaluated_points", tuning.search.evaluated.size())
      .with("grid_points", config.grid.size());
}

std::string metrics_text(const TuningResult& result) {
  const TuneOptions& options = result.config.options;
  Json json;
  for (const MethodTuning& tuning : result.tunings) {
    json["methods"][tuning.method] = tuning_json(result.config, tuning);
  }
  json["objective"] = options.objective;
  if (options.objective == "weighted") json["vertical_weight"] = options.vertical_weight;
  json["search"] = options.search;
  json["version"] = result.version;
  json["base"] = result.base;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// A row a pair of values; empty where nothing was evaluated.
evaluation::TextTable heat_map_table(const TuneConfig& config, const MethodTuning& tuning,
                                     std::size_t x, std::size_t y) {
  const std::vector<GridAxis>& axes = config.grid.axes;
  const std::vector<std::vector<double>> least = profile(config.grid, tuning.search, x, y);
  evaluation::TextTable table{"", {axes[x].key, axes[y].key, "objective_m"}, {}};
  for (std::size_t row = 0; row < least.size(); ++row) {
    for (std::size_t column = 0; column < least[row].size(); ++column) {
      table.rows.push_back(
          {axes[x].values[column], axes[y].values[row], finite_text(least[row][column])});
    }
  }
  return table;
}

bool on_edge(const GridAxis& axis, std::size_t index) {
  return axis.ordered && axis.values.size() > 2 && (index == 0 || index + 1 == axis.values.size());
}

std::string best_file(const TuneConfig& config, const std::string& method) {
  return config.methods.size() == 1 ? "best.yaml" : fmt::format("best-{}.yaml", method);
}

}  // namespace

std::string map_name(const std::string& method, const std::vector<std::string>& keys) {
  std::string name = method;
  for (const std::string& key : keys) name += "_" + key;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

evaluation::TextTable best_table(const TuningResult& result) {
  const TuneConfig& config = result.config;
  evaluation::TextTable table{fmt::format("Smallest {}", config.options.objective_name()),
                              {"Method", "Horizontal (m)", "Vertical (m)", "Outages", "Points"},
                              {}};
  for (const GridAxis& axis : config.grid.axes) table.header.push_back(axis.key);
  for (const MethodTuning& tuning : result.tunings) {
    std::vector<std::string> row{
        tuning.method, fmt::format("{:.2f}", tuning.best().horizontal_rms),
        fmt::format("{:.2f}", tuning.best().vertical_rms), fmt::format("{}", tuning.best().outages),
        fmt::format("{} of {}", tuning.search.evaluated.size(), config.grid.size())};
    for (const std::string& value : config.values(tuning.search.best)) row.push_back(value);
    table.rows.push_back(row);
  }
  return table;
}

std::vector<std::string> edge_lines(const TuningResult& result) {
  const std::vector<GridAxis>& axes = result.config.grid.axes;
  std::vector<std::string> lines;
  for (const MethodTuning& tuning : result.tunings) {
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!on_edge(axes[a], tuning.search.best[a])) continue;
      lines.push_back(
          fmt::format("{}: {} = {} is at the edge of the grid; a wider one may do better",
                      tuning.method, axes[a].key, axes[a].values[tuning.search.best[a]]));
    }
  }
  return lines;
}

void write_tuning(const TuningResult& result,
                  const std::function<std::string(const GridPoint&)>& config_at,
                  const std::filesystem::path& folder) {
  const TuneConfig& config = result.config;
  exports::write_text_file(folder / "results.csv", evaluation::to_csv(results_table(result)));
  exports::write_text_file(folder / "points.csv", evaluation::to_csv(points_table(result)));
  exports::write_text_file(folder / "metrics.json", metrics_text(result));
  for (const MethodTuning& tuning : result.tunings) {
    exports::write_text_file(folder / best_file(config, tuning.method),
                             config_at(tuning.search.best));
    for_each_pair(config.grid, [&](std::size_t x, std::size_t y) {
      const std::vector<GridAxis>& axes = config.grid.axes;
      const std::string name = map_name(tuning.method, {axes[x].key, axes[y].key}) + ".csv";
      std::filesystem::create_directories(folder / "heatmaps");
      exports::write_text_file(folder / "heatmaps" / name,
                               evaluation::to_csv(heat_map_table(config, tuning, x, y)));
    });
  }
}

std::vector<std::string> tuning_lines(const TuningResult& result,
                                      const std::filesystem::path& folder) {
  std::vector<std::string> lines =
      evaluation::text_lines(evaluation::to_plain_text(best_table(result)));
  for (const std::string& edge : edge_lines(result)) lines.push_back(edge);
  for (const MethodTuning& tuning : result.tunings) {
    const std::filesystem::path best = folder / best_file(result.config, tuning.method);
    lines.push_back(fmt::format("use it     foucault run LOG --config {} --method {} --out DIR",
                                best.string(), tuning.method));
  }
  return lines;
}

}  // namespace foucault::tuning
