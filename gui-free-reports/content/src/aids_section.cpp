#include "aids_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "foucault/plot/text.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

/// "zero_velocity": "Zero velocity".
std::string title_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  if (!name.empty()) name[0] = static_cast<char>(std::toupper(name[0]));
  if (name.rfind("Gnss", 0) == 0) name.replace(0, 4, "GNSS");
  return name;
}

std::string mean_text(const AidSummary& aid) {
  return aid.used > 0 ? significant_text(aid.mean_nis / aid.dimension) : "–";
}

Table aids_table(const std::vector<AidSummary>& aids) {
  Table table;
  table.title = "Measurements beside positions";
  table.header = {"", "Used", "Rejected", "Dimension", "Mean NIS / dimension"};
  for (const AidSummary& aid : aids) {
    table.rows.push_back({title_of(aid.name), std::to_string(aid.used),
                          std::to_string(aid.rejected), std::to_string(aid.dimension),
                          mean_text(aid)});
  }
  table.note =
      "NIS: innovations of used measurements, squared by their covariance. Over the dimension it "
      "is 1 in the mean if that is right; below 1, the measurement is trusted less than it might "
      "be.";
  return table;
}

/// Logarithmic, with the bounds and nine tenths of the values; what lies far out becomes
/// arrowheads.
Axis aid_axis(const AidSummary& aid, const std::vector<double>& values, double largest) {
  constexpr double kHighest = 1e3;
  Axis axis{aid.dimension == 1 ? "NIS" : fmt::format("NIS / {}", aid.dimension), {}, AxisKind::log};
  axis.min = std::min(0.5 * aid.single_band.low / aid.dimension,
                      0.7 * positive_quantile(values, 0.1).value_or(1));
  axis.max = 1.5 * std::clamp(largest, 10.0, kHighest);
  return axis;
}

Series squares(const char* label, Ink ink, double size, const DecimatedTable::Rows& rows,
               const std::string& column) {
  Series series = points(label, ink, size, rows.x, rows.columns[0]);
  series.column = column;
  return series;
}

Panel aid_panel(const RunData& data, const AidSummary& aid, const SquareHistory& history) {
  const DecimatedTable::Rows used = history.used.rows();
  const DecimatedTable::Rows rejected = history.rejected.rows();
  const std::string title = title_of(aid.name);
  const double largest =
      std::max(largest_finite(used.columns[0]), largest_finite(rejected.columns[0]));
  Panel panel = time_panel(data, aid_axis(aid, used.columns[0], largest));
  panel.title = title;
  panel.note =
      fmt::format("mean {} · {} used, {} rejected", mean_text(aid), aid.used, aid.rejected);
  if (!used.x.empty()) {
    panel.series.push_back(squares("used", Ink::blue, 2.4, used, title + " NIS"));
  }
  if (!rejected.x.empty()) {
    panel.series.push_back(
        squares("rejected", Ink::vermillion, 5, rejected, title + " NIS rejected"));
    panel.series.back().shape = Shape::cross;
  }
  const double d = aid.dimension;
  const Interval whole = whole_run(data);
  add_bounds({aid.single_band.low / d, aid.single_band.high / d}, "95 % for one measurement",
             {whole.begin, whole.end}, panel);
  return panel;
}

Figure squares_figure(const RunData& data, const std::vector<AidSummary>& aids,
                      const std::string& subtitle) {
  Figure figure = stacked_figure(
      "aid_innovations", "Normalized innovations of aids", subtitle,
      "Innovation of each measurement beside positions, squared by its covariance, over its "
      "dimension. Between the dashed lines lie 95 % if the covariances are right; a level below "
      "means that the measurement is trusted less than it might be, one above, and clusters of "
      "rejected ones, that it does not hold there.");
  for (const AidSummary& aid : aids) {
    const auto history = data.aids.find(aid.name);
    if (history != data.aids.end()) {
      figure.panels.push_back(aid_panel(data, aid, history->second));
    }
  }
  figure.height_mm = 40 + 46 * static_cast<double>(figure.panels.size());
  return figure;
}

}  // namespace

Section aids_section(const RunData& data, const std::vector<AidSummary>& aids,
                     const std::string& subtitle) {
  Section section{"Aids"};
  if (aids.empty()) return section;
  section.tables = {aids_table(aids)};
  Figure figure = squares_figure(data, aids, subtitle);
  if (!figure.panels.empty()) section.figures.push_back(std::move(figure));
  return section;
}

}  // namespace foucault::content
