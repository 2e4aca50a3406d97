#include "processing_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "foucault/plot/text.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

/// With fewer there is nothing to see over time: smoothers solve once for the whole recording.
constexpr int64_t kFewestDrawn = 10;

Table solver_table(const SolveTotals& totals) {
  const auto count = static_cast<double>(totals.count);
  const auto milliseconds = [](double seconds) { return significant_text(1000 * seconds) + " ms"; };
  Table table;
  table.title = "Solver";
  table.header = {"", "Mean", "Largest", "Together"};
  table.rows = {
      {"Nodes", significant_text(totals.nodes / count), number_text(totals.most_nodes, 0), ""},
      {"Iterations", significant_text(totals.iterations / count),
       number_text(totals.most_iterations, 0), number_text(totals.iterations, 0)},
      {"Time", milliseconds(totals.seconds / count), milliseconds(totals.longest),
       significant_text(totals.seconds) + " s"}};
  table.note = totals.count < kFewestDrawn
                   ? fmt::format("Optimizations: {}, over the recording as a whole.", totals.count)
                   : fmt::format("Optimizations: {}, one a measurement.", totals.count);
  return table;
}

Table stage_table(const std::vector<StageTime>& stages) {
  const double total =
      std::accumulate(stages.begin(), stages.end(), 0.0,
                      [](double sum, const StageTime& stage) { return sum + stage.seconds; });
  Table table;
  table.title = "CPU time until the drawing";
  table.header = {"", "Time", "Share"};
  for (const StageTime& stage : stages) {
    table.rows.push_back({stage_name(stage.stage), number_text(stage.seconds, 3) + " s",
                          number_text(100 * stage.seconds / total, 1) + " %"});
  }
  table.note =
      "Survey: the ways through the recording that find what is wrong with it, clocks and noise "
      "before. `run --profile` has the drawing, too.";
  return table;
}

Figure solver_figure(const RunData& data, const std::string& subtitle) {
  const DecimatedTable::Rows rows = data.solves.rows();
  Figure figure = stacked_figure(
      "solver", "Iterations and time of the solver", subtitle,
      "Of each optimization: how often it iterated, and how long it took. Many iterations follow "
      "starts, outages and fixes that do not fit; where nothing happens one or two are enough.");
  figure.height_mm = 125;
  Panel iterations = time_panel(data, {"Iterations", ""});
  iterations.y.from_zero = true;
  iterations.series = {points("iterations", Ink::blue, 2.4, rows.x, rows.columns[0])};
  Panel time = time_panel(data, {"Time", "ms", AxisKind::log});
  time.series = {points("time", Ink::blue, 2.4, rows.x, rows.columns[1])};
  for (Panel* panel : {&iterations, &time}) {
    panel->series[0].in_legend = false;
    figure.panels.push_back(std::move(*panel));
  }
  return figure;
}

}  // namespace

Section processing_section(const RunData& data, const std::vector<StageTime>& stages,
                           const std::string& subtitle) {
  Section section{"Processing"};
  if (data.solve_totals.count > 0) section.tables.push_back(solver_table(data.solve_totals));
  if (!stages.empty()) section.tables.push_back(stage_table(stages));
  if (data.solve_totals.count >= kFewestDrawn) {
    section.figures.push_back(solver_figure(data, subtitle));
  }
  return section;
}

}  // namespace foucault::content
