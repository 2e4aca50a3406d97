#include "pages/tuning_page.h"

#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "foucault/content/evaluation_report.h"
#include "pages/evaluation_page.h"

namespace foucault::app {
namespace {

using tuning::GridAxis;
using tuning::MethodTuning;
using tuning::ParameterGrid;
using tuning::TuneConfig;

std::vector<double> numbers(const GridAxis& axis) {
  std::vector<double> values;
  for (const std::string& text : axis.values) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    values.push_back(value);
  }
  return values;
}

plot::Figure heat_map(const TuneConfig& config, const MethodTuning& found, std::size_t x,
                      std::size_t y) {
  const std::vector<GridAxis>& axes = config.grid.axes;
  content::ParameterMap map;
  map.name = tuning::map_name(found.method, {axes[x].key, axes[y].key});
  map.title = config.options.objective_name();
  map.subtitle = found.method;
  map.x_label = axes[x].key;
  map.y_label = axes[y].key;
  map.x = numbers(axes[x]);
  map.y = numbers(axes[y]);
  for (const std::vector<double>& row : tuning::profile(config.grid, found.search, x, y)) {
    map.values.insert(map.values.end(), row.begin(), row.end());
  }
  map.value_label = config.options.objective_name();
  map.value_unit = "m";
  map.chosen = std::pair(found.search.best[x], found.search.best[y]);
  return content::parameter_map(map);
}

/// The only parameter's curve.
plot::Figure single_curve(const TuneConfig& config, const MethodTuning& found) {
  const GridAxis& axis = config.grid.axes.front();
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
  for (const auto& [point, value] : found.search.evaluated) {
    line.x.push_back(values[point.front()]);
    line.y.push_back(value);
  }
  chosen.x = {values[found.search.best.front()]};
  chosen.y = {found.search.value};
  plot::Panel panel;
  panel.x.label = axis.key;
  panel.y.label = config.options.objective_name();
  panel.y.unit = "m";
  panel.series = {line, chosen};
  plot::Figure figure;
  figure.name = tuning::map_name(found.method, {axis.key});
  figure.title = panel.y.label;
  figure.subtitle = found.method;
  figure.caption = "The objective over the parameter; the ring marks the chosen value.";
  figure.panels = {panel};
  return figure;
}

std::vector<plot::Figure> figures(const TuneConfig& config, const MethodTuning& found) {
  const ParameterGrid& grid = config.grid;
  std::vector<plot::Figure> figures;
  if (grid.axes.size() == 1 && grid.axes.front().ordered) {
    figures.push_back(single_curve(config, found));
  }
  tuning::for_each_pair(grid, [&](std::size_t x, std::size_t y) {
    if (grid.axes[x].ordered && grid.axes[y].ordered) {
      figures.push_back(heat_map(config, found, x, y));
    }
  });
  return figures;
}

std::vector<page::KeyNumber> key_numbers(const std::vector<MethodTuning>& tunings) {
  std::vector<page::KeyNumber> numbers;
  for (const MethodTuning& found : tunings) {
    const tuning::PointScore& score = found.best();
    numbers.push_back(
        {fmt::format("{}, horizontal RMS", found.method),
         fmt::format("{:.2f}", score.horizontal_rms), "m",
         fmt::format("vertical {:.2f} m, {} outages", score.vertical_rms, score.outages)});
  }
  return numbers;
}

}  // namespace

page::ReportPage tuning_page(const tuning::TuningResult& result, std::size_t recordings,
                             const std::string& command_line) {
  const TuneConfig& config = result.config;
  page::ReportPage page;
  page.title = "Parameter search";
  page.subtitle =
      fmt::format("{} over {} points of a grid, {} recording{}", config.options.objective_name(),
                  config.grid.size(), recordings, recordings == 1 ? "" : "s");
  page.key_numbers = key_numbers(result.tunings);
  page::Section overview{"Overview", tuning::edge_lines(result), {}, {}};
  overview.tables.push_back(report_table(tuning::best_table(result)));
  page.sections.push_back(std::move(overview));
  for (const MethodTuning& of_method : result.tunings) {
    page::Section section{of_method.method, {}, {}, figures(config, of_method)};
    if (!section.figures.empty()) page.sections.push_back(std::move(section));
  }
  page.listings.push_back({"Command", command_line});
  page.listings.push_back({"Base configuration", result.base});
  page.footer = fmt::format("foucault {}", result.version);
  return page;
}

}  // namespace foucault::app
