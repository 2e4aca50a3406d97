#include "tune_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "evaluation_report.h"
#include "foucault/content/evaluation_report.h"
#include "foucault/evaluation/drift_table.h"
#include "text_file.h"
#include "version.h"

namespace foucault::app {
namespace {

using Json = nlohmann::ordered_json;

std::string finite_text(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

/// Every evaluated point, in the order of the grid.
TextTable results_table(const TuneJob& job, const std::vector<MethodTuning>& tunings) {
  const ParameterGrid& grid = job.config.grid;
  TextTable table;
  table.header.push_back("method");
  for (const GridAxis& axis : grid.axes) table.header.push_back(axis.key);
  for (const char* name :
       {"outages", "horizontal_rmse_m", "vertical_rmse_m", "objective_m", "best", "note"}) {
    table.header.push_back(name);
  }
  for (const MethodTuning& tuning : tunings) {
    for (const auto& [point, score] : tuning.scores) {
      std::vector<std::string> row{tuning.method};
      for (std::size_t a = 0; a < point.size(); ++a) row.push_back(grid.axes[a].values[point[a]]);
      row.push_back(fmt::format("{}", score.outages));
      row.push_back(finite_text(score.horizontal_rms));
      row.push_back(finite_text(score.vertical_rms));
      row.push_back(finite_text(tuning.search.evaluated.at(point)));
      row.push_back(point == tuning.search.best ? "1" : "0");
      row.push_back(score.note);
      table.rows.push_back(row);
    }
  }
  return table;
}

Json tuning_json(const TuneJob& job, const MethodTuning& tuning) {
  const ParameterGrid& grid = job.config.grid;
  const PointScore& score = tuning.scores.at(tuning.search.best);
  Json parameters = Json::object();
  for (std::size_t a = 0; a < grid.axes.size(); ++a) {
    parameters[grid.axes[a].key] = grid.axes[a].values[tuning.search.best[a]];
  }
  return {{"outages", score.outages},
          {"horizontal_rmse_m", score.horizontal_rms},
          {"vertical_rmse_m", score.vertical_rms},
          {"objective_m", tuning.search.value},
          {"parameters", parameters},
          {"evaluated_points", tuning.search.evaluated.size()},
          {"grid_points", grid.size()}};
}

std::string metrics_text(const TuneJob& job, const std::vector<MethodTuning>& tunings) {
  Settings base = job.config.base;
  Json json;
  for (const MethodTuning& tuning : tunings)
    json["methods"][tuning.method] = tuning_json(job, tuning);
  json["objective"] = job.config.options.objective;
  if (job.config.options.objective == "weighted") {
    json["vertical_weight"] = job.config.options.vertical_weight;
  }
  json["search"] = job.config.options.search;
  json["version"] = kVersion;
  json["base"] = dump_config(base);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Letters, digits and '_' only.
std::string file_part(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return text;
}

std::string map_name(const TuneJob& job, const MethodTuning& tuning, std::size_t x, std::size_t y) {
  const std::vector<GridAxis>& axes = job.config.grid.axes;
  return fmt::format("{}_{}_{}", file_part(tuning.method), file_part(axes[x].key),
                     file_part(axes[y].key));
}

/// A row a pair of values; empty where nothing was evaluated.
TextTable heat_map_table(const TuneJob& job, const MethodTuning& tuning, std::size_t x,
                         std::size_t y) {
  const std::vector<GridAxis>& axes = job.config.grid.axes;
  const std::vector<std::vector<double>> least = profile(job.config.grid, tuning.search, x, y);
  TextTable table{"", {axes[x].key, axes[y].key, "objective_m"}, {}};
  for (std::size_t row = 0; row < least.size(); ++row) {
    for (std::size_t column = 0; column < least[row].size(); ++column) {
      table.rows.push_back(
          {axes[x].values[column], axes[y].values[row], finite_text(least[row][column])});
    }
  }
  return table;
}

/// Each pair of parameters once.
template <class Use>
void for_each_pair(const ParameterGrid& grid, Use use) {
  for (std::size_t x = 0; x < grid.axes.size(); ++x) {
    for (std::size_t y = x + 1; y < grid.axes.size(); ++y) use(x, y);
  }
}

bool on_edge(const GridAxis& axis, std::size_t index) {
  return axis.ordered && axis.values.size() > 2 && (index == 0 || index + 1 == axis.values.size());
}

std::vector<double> numbers(const GridAxis& axis) {
  std::vector<double> values;
  for (const std::string& text : axis.values) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    values.push_back(value);
  }
  return values;
}

std::string objective_name(const TuneOptions& options) {
  if (options.objective != "weighted") return fmt::format("RMS {} drift", options.objective);
  return fmt::format("RMS drift, horizontal + {} vertical", options.vertical_weight);
}

plot::Figure heat_map(const TuneJob& job, const MethodTuning& tuning, std::size_t x,
                      std::size_t y) {
  const std::vector<GridAxis>& axes = job.config.grid.axes;
  content::ParameterMap map;
  map.name = map_name(job, tuning, x, y);
  map.title = objective_name(job.config.options);
  map.subtitle = tuning.method;
  map.x_label = axes[x].key;
  map.y_label = axes[y].key;
  map.x = numbers(axes[x]);
  map.y = numbers(axes[y]);
  for (const std::vector<double>& row : profile(job.config.grid, tuning.search, x, y)) {
    map.values.insert(map.values.end(), row.begin(), row.end());
  }
  map.value_label = objective_name(job.config.options);
  map.value_unit = "m";
  map.chosen = std::pair(tuning.search.best[x], tuning.search.best[y]);
  return content::parameter_map(map);
}

/// The only parameter's curve.
plot::Figure single_curve(const TuneJob& job, const MethodTuning& tuning) {
  const GridAxis& axis = job.config.grid.axes.front();
  plot::Series line;
  line.label = "objective";
  line.in_legend = false;
  plot::Series chosen;
  chosen.label = "chosen";
  chosen.mark = plot::Mark::points;
  chosen.shape = plot::Shape::ring;
  chosen.size = 6;
  chosen.ink = plot::Ink::vermillion;
  const std::vector<double> values = numbers(axis);
  for (const auto& [point, value] : tuning.search.evaluated) {
    line.x.push_back(values[point.front()]);
    line.y.push_back(value);
  }
  chosen.x = {values[tuning.search.best.front()]};
  chosen.y = {tuning.search.value};
  plot::Panel panel;
  panel.x.label = axis.key;
  panel.y.label = objective_name(job.config.options);
  panel.y.unit = "m";
  panel.series = {line, chosen};
  plot::Figure figure;
  figure.name = fmt::format("{}_{}", file_part(tuning.method), file_part(axis.key));
  figure.title = panel.y.label;
  figure.subtitle = tuning.method;
  figure.caption = "The objective over the parameter; the ring marks the chosen value.";
  figure.panels = {panel};
  return figure;
}

std::vector<plot::Figure> figures(const TuneJob& job, const MethodTuning& tuning) {
  const ParameterGrid& grid = job.config.grid;
  std::vector<plot::Figure> figures;
  if (grid.axes.size() == 1 && grid.axes.front().ordered) {
    figures.push_back(single_curve(job, tuning));
  }
  for_each_pair(grid, [&](std::size_t x, std::size_t y) {
    if (grid.axes[x].ordered && grid.axes[y].ordered) {
      figures.push_back(heat_map(job, tuning, x, y));
    }
  });
  return figures;
}

/// The chosen values of all methods.
TextTable best_table(const TuneJob& job, const std::vector<MethodTuning>& tunings) {
  const ParameterGrid& grid = job.config.grid;
  TextTable table{fmt::format("Smallest {}", objective_name(job.config.options)),
                  {"Method", "Horizontal (m)", "Vertical (m)", "Outages", "Points"},
                  {}};
  for (const GridAxis& axis : grid.axes) table.header.push_back(axis.key);
  for (const MethodTuning& tuning : tunings) {
    const PointScore& score = tuning.scores.at(tuning.search.best);
    std::vector<std::string> row{
        tuning.method, fmt::format("{:.2f}", score.horizontal_rms),
        fmt::format("{:.2f}", score.vertical_rms), fmt::format("{}", score.outages),
        fmt::format("{} of {}", tuning.search.evaluated.size(), grid.size())};
    for (std::size_t a = 0; a < grid.axes.size(); ++a) {
      row.push_back(grid.axes[a].values[tuning.search.best[a]]);
    }
    table.rows.push_back(row);
  }
  return table;
}

/// Where a wider grid might hold something better.
std::vector<std::string> edge_lines(const TuneJob& job, const std::vector<MethodTuning>& tunings) {
  std::vector<std::string> lines;
  for (const MethodTuning& tuning : tunings) {
    for (std::size_t a = 0; a < job.config.grid.axes.size(); ++a) {
      const GridAxis& axis = job.config.grid.axes[a];
      if (!on_edge(axis, tuning.search.best[a])) continue;
      lines.push_back(
          fmt::format("{}: {} = {} is at the edge of the grid; a wider one may do better",
                      tuning.method, axis.key, axis.values[tuning.search.best[a]]));
    }
  }
  return lines;
}

std::vector<page::KeyNumber> key_numbers(const std::vector<MethodTuning>& tunings) {
  std::vector<page::KeyNumber> numbers;
  for (const MethodTuning& tuning : tunings) {
    const PointScore& score = tuning.scores.at(tuning.search.best);
    numbers.push_back(
        {fmt::format("{}, horizontal RMS", tuning.method),
         fmt::format("{:.2f}", score.horizontal_rms), "m",
         fmt::format("vertical {:.2f} m, {} outages", score.vertical_rms, score.outages)});
  }
  return numbers;
}

}  // namespace

std::string best_file(const TuneJob& job, const std::string& method) {
  const bool only_one = job.config.options.methods_to_tune().size() == 1;
  return only_one ? "best.yaml" : fmt::format("best-{}.yaml", method);
}

void write_tuning(const TuneJob& job, const std::vector<MethodTuning>& tunings,
                  const std::filesystem::path& folder) {
  write_text_file(folder / "results.csv", to_csv(results_table(job, tunings)));
  write_text_file(folder / "metrics.json", metrics_text(job, tunings));
  for (const MethodTuning& tuning : tunings) {
    Settings best = job.config.at(tuning.search.best);
    write_text_file(folder / best_file(job, tuning.method), dump_config(best));
    for_each_pair(job.config.grid, [&](std::size_t x, std::size_t y) {
      std::filesystem::create_directories(folder / "heatmaps");
      write_text_file(folder / "heatmaps" / (map_name(job, tuning, x, y) + ".csv"),
                      to_csv(heat_map_table(job, tuning, x, y)));
    });
  }
}

std::vector<std::string> tuning_lines(const TuneJob& job,
                                      const std::vector<MethodTuning>& tunings) {
  std::vector<std::string> lines = text_lines(to_plain_text(best_table(job, tunings)));
  const std::vector<std::string> edges = edge_lines(job, tunings);
  lines.insert(lines.end(), edges.begin(), edges.end());
  for (const MethodTuning& tuning : tunings) {
    const std::filesystem::path best =
        std::filesystem::path(job.out) / best_file(job, tuning.method);
    lines.push_back(fmt::format("use it     foucault run LOG --config {} --method {} --out DIR",
                                best.string(), tuning.method));
  }
  return lines;
}

page::ReportPage tuning_page(const TuneJob& job, const std::vector<MethodTuning>& tunings) {
  Settings base = job.config.base;
  page::ReportPage page;
  page.title = "Parameter search";
  page.subtitle =
      fmt::format("{} over {} points of a grid, {} recording{}", objective_name(job.config.options),
                  job.config.grid.size(), job.logs.size(), job.logs.size() == 1 ? "" : "s");
  page.key_numbers = key_numbers(tunings);
  page::Section overview{"Overview", edge_lines(job, tunings), {}, {}};
  overview.tables.push_back(report_table(best_table(job, tunings)));
  page.sections.push_back(std::move(overview));
  for (const MethodTuning& tuning : tunings) {
    page::Section section{tuning.method, {}, {}, figures(job, tuning)};
    if (!section.figures.empty()) page.sections.push_back(std::move(section));
  }
  page.listings.push_back({"Command", job.command_line});
  page.listings.push_back({"Base configuration", dump_config(base)});
  page.footer = fmt::format("foucault {}", kVersion);
  return page;
}

}  // namespace foucault::app
