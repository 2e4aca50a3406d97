#include "calibration_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "foucault/core/constants.h"
#include "foucault/plot/axis_scale.h"
#include "foucault/plot/text.h"
#include "foucault/state/told_blocks.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

/// How a block is shown.
struct BlockLook {
  std::string_view name;
  std::string title;
  std::string unit;
  double factor = 1;                   ///< from SI
  std::vector<const char*> rows = {};  ///< empty: numbers
};

struct FigureLook {
  const char* name;
  const char* title;
  std::vector<BlockLook> blocks;
};

const std::vector<const char*> kAlongVehicle{"forward", "right", "down"};

std::vector<FigureLook> known_looks() {
  constexpr double kPpm = 1e6;
  return {
      {"calibration_arms",
       "Calibration: lever arms",
       {{"lever_arm", "Antenna", "m", 1, kAlongVehicle},
        {"wheel_lever_arm", "Point without slip", "m", 1, kAlongVehicle}}},
      {"calibration_vehicle",
       "Calibration: mounting, wheels, time",
       {{"mounting", "Mounting", "°", 1 / kDegree, {"pitch", "heading"}},
        {"baseline_heading", "Baseline of antennas", "°", 1 / kDegree, {""}},
        {"wheel_scale", "Wheel scale", "%", 100, {""}},
        {"cornering_compliance", "Cornering compliance", "mrad/(m/s²)", 1000, {""}},
        {"time_offset", "Time offset", "ms", 1000, {""}},
        {"time_drift", "Time drift", "ppm", kPpm, {""}}}},
      {"calibration_scales",
       "Calibration: scale factors",
       {{"gyro_scale", "Gyro scale", "ppm", kPpm, {"x", "y", "z"}},
        {"accel_scale", "Accel. scale", "ppm", kPpm, {"x", "y", "z"}}}},
      {"calibration_cross_axes",
       "Calibration: cross-axis terms",
       {{"gyro_cross_axis", "Gyro cross-axis", "ppm", kPpm, {"xy", "yz", "zx", "xz", "yx", "zy"}},
        {"accel_cross_axis", "Accel. cross-axis", "ppm", kPpm, {"xy", "yz", "xz"}}}},
  };
}

/// Blocks that have no look of their own are shown as they are.
std::vector<FigureLook> figure_looks(const RunData& data) {
  std::vector<FigureLook> looks = known_looks();
  FigureLook other{"calibration_other", "Calibration: other blocks", {}};
  for (const BlockHistory& history : data.blocks) {
    const state::Block& block = history.slow.block;
    const bool known = std::any_of(looks.begin(), looks.end(), [&](const FigureLook& look) {
      return std::any_of(look.blocks.begin(), look.blocks.end(),
                         [&](const BlockLook& b) { return b.name == block.name; });
    });
    if (!known)
      other.blocks.push_back({block.name, std::string(block.name), std::string(block.unit)});
  }
  looks.push_back(std::move(other));
  return looks;
}

/// One number of a block over time, in the unit that it is shown in.
struct ShownRow {
  std::string block;  ///< its title
  std::string name;   ///< in the block; empty if it is the only one
  std::string unit;
  double prior = 0, prior_sigma = 0;
  double last = 0, last_sigma = 0;
  std::vector<double> t, value, sigma;
  bool smoothed = false;  ///< these are of the forward run, before the last ones

  /// The recording has told at least something of it.
  bool told() const { return last_sigma <= state::kLeftWhereTold * prior_sigma; }
  bool left_prior() const { return std::abs(last - prior) > 3 * prior_sigma; }
  std::string title() const { return name.empty() ? block : block + ", " + name; }
};

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

ShownRow shown_row(const BlockHistory& block, const BlockLook& look, Eigen::Index row) {
  const auto i = static_cast<size_t>(row);
  const auto size = static_cast<size_t>(block.slow.block.size);
  ShownRow shown;
  shown.smoothed = !block.forward.empty();
  DecimatedTable::Rows rows = (shown.smoothed ? block.forward : block.rows).rows();
  shown.block = look.title;
  shown.name = i < look.rows.size() ? look.rows[i] : std::to_string(i + 1);
  shown.unit = look.unit;
  shown.prior = look.factor * block.prior[row];
  shown.prior_sigma = look.factor * block.prior_sigma[row];
  shown.last = look.factor * block.last[row];
  shown.last_sigma = look.factor * block.last_sigma[row];
  shown.t = std::move(rows.x);
  shown.value = scaled(std::move(rows.columns[i]), look.factor);
  shown.sigma = scaled(std::move(rows.columns[i + size]), look.factor);
  return shown;
}

void add_rows(const BlockHistory& block, const BlockLook& look, std::vector<ShownRow>& rows) {
  if (block.rows.empty()) return;
  for (Eigen::Index row = 0; row < block.slow.block.size; ++row) {
    rows.push_back(shown_row(block, look, row));
  }
}

/// As many as two digits of the sigma have.
int decimals_of(const ShownRow& row) {
  if (!(row.last_sigma > 0) || !std::isfinite(row.last_sigma)) return 3;
  return std::max(0, 1 - static_cast<int>(std::floor(std::log10(row.last_sigma))));
}

std::string value_text(const ShownRow& row) {
  const int decimals = decimals_of(row);
  return fmt::format("{} ± {}{}{}", number_text(row.last, decimals),
                     number_text(row.last_sigma, decimals), row.unit == "°" ? "" : " ", row.unit);
}

/// Of the estimate within its bounds in the second half of the run, and of the smoothed one;
/// empty without finite numbers.
Span settled_span(const ShownRow& row) {
  Span span{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  const double settled = (row.t.front() + row.t.back()) / 2;
  for (size_t i = 0; i < row.t.size(); ++i) {
    const double width = 3 * row.sigma[i];
    if (!(row.t[i] >= settled) || !std::isfinite(row.value[i]) || !std::isfinite(width)) continue;
    span.min = std::min(span.min, row.value[i] - width);
    span.max = std::max(span.max, row.value[i] + width);
  }
  if (!row.smoothed) return span;
  return {std::min(span.min, row.last - 3 * row.last_sigma),
          std::max(span.max, row.last + 3 * row.last_sigma)};
}

void add_prior_line(const ShownRow& row, double at, const char* edge, Panel& panel) {
  Series series = line("prior ±3σ", Ink::gray, {row.t.front(), row.t.back()}, {at, at});
  series.column = fmt::format("{} prior {}", row.title(), edge);
  series.dash = Dash::dashes;
  series.size = 1.4;
  panel.series.push_back(std::move(series));
}

/// The axis is for what has settled; the prior is left out where it is so wide that the estimate
/// would be a line beside it.
void add_axis_and_prior(const ShownRow& row, Panel& panel) {
  constexpr double kWidest = 2;  // of the axis
  constexpr double kMargin = 0.05;
  Span span = settled_span(row);
  if (!(span.width() >= 0)) return;
  const Span prior{row.prior - 3 * row.prior_sigma, row.prior + 3 * row.prior_sigma};
  if (!row.told() || prior.width() < kWidest * span.width()) {
    span = {std::min(span.min, prior.min), std::max(span.max, prior.max)};
    add_prior_line(row, prior.min, "lower", panel);
    add_prior_line(row, prior.max, "upper", panel);
  }
  panel.y.min = span.min - kMargin * span.width();
  panel.y.max = span.max + kMargin * span.width();
}

/// One value for the whole recording, with what it may be wrong by.
void add_smoothed(const ShownRow& row, Panel& panel) {
  const std::vector<double> whole{row.t.front(), row.t.back()};
  for (const double sigmas : {-3.0, 0.0, 3.0}) {
    const double at = row.last + sigmas * row.last_sigma;
    Series series =
        line(sigmas == 0 ? "smoothed" : "smoothed ±3σ", Ink::vermillion, whole, {at, at});
    series.column = fmt::format("{} smoothed {:+.0f} sigma", row.title(), sigmas);
    series.dash = sigmas == 0 ? Dash::long_dashes : Dash::dots;
    panel.series.push_back(std::move(series));
  }
}

Panel row_panel(const RunData& data, const ShownRow& row) {
  const bool is_alone = row.name.empty();  // and may have a long name
  Panel panel = time_panel(data, {is_alone ? "" : row.block, row.unit});
  panel.title = is_alone ? row.block : row.name;
  panel.note = value_text(row);
  panel.series = {bounds(row.t, row.value, row.sigma, row.title() + " 3 sigma"),
                  line(row.smoothed ? "run forward" : "estimate", Ink::blue, row.t, row.value)};
  panel.series.back().column = row.title();
  add_axis_and_prior(row, panel);
  if (row.smoothed) add_smoothed(row, panel);
  return panel;
}

Figure rows_figure(const RunData& data, const FigureLook& look, const std::vector<ShownRow>& rows,
                   const std::string& subtitle) {
  const bool is_smoothed = rows.front().smoothed;
  Figure figure = stacked_figure(
      look.name, look.title, subtitle,
      fmt::format(
          "{} and, where they are not far wider, those of the prior (dashed); at the right what is "
          "known in the end, with 1 sigma. Axes are for the second half of the run. What the "
          "recording tells narrows as the vehicle turns and accelerates and then stays within the "
          "bounds it had before; what it does not tell keeps the width of its prior.",
          is_smoothed
              ? "Estimates of the run forward with their 3-sigma bounds, the one value that "
                "smoothing finds for the whole recording with its own"
              : "Estimates with their 3-sigma bounds"));
  const size_t count = rows.size();
  figure.columns = count == 4 ? 2 : static_cast<int>(std::min<size_t>(count, 3));
  const size_t columns = static_cast<size_t>(figure.columns);
  figure.height_mm = 40 + 50 * static_cast<double>((count + columns - 1) / columns);
  for (const ShownRow& row : rows) figure.panels.push_back(row_panel(data, row));
  return figure;
}

Table calibration_table(const std::vector<ShownRow>& rows) {
  Table table;
  table.title = "At the end";
  table.header = {"", "Unit", "Estimate", "1σ", "1σ of the prior", "Share"};
  for (const ShownRow& row : rows) {
    table.rows.push_back({row.title(), row.unit, number_text(row.last, decimals_of(row)),
                          number_text(row.last_sigma, decimals_of(row)),
                          significant_text(row.prior_sigma),
                          number_text(100 * row.last_sigma / row.prior_sigma, 0) + " %"});
  }
  table.note =
      "Share: of the prior's sigma that is left. Lever arms are from the IMU, along the vehicle's "
      "axes; the mounting is what those have to be turned by that were told.";
  return table;
}

std::string listed_rows(const std::vector<ShownRow>& rows, bool (*belongs)(const ShownRow&)) {
  std::vector<std::string> titles;
  for (const ShownRow& row : rows) {
    if (belongs(row)) titles.push_back(row.title());
  }
  return fmt::format("{}", fmt::join(titles, "; "));
}

/// What the recording does not tell, and what has left its prior all the same.
std::vector<std::string> untold_texts(const std::vector<ShownRow>& rows) {
  const std::string untold =
      listed_rows(rows, [](const ShownRow& row) { return !row.told() && !row.left_prior(); });
  const std::string astray =
      listed_rows(rows, [](const ShownRow& row) { return !row.told() && row.left_prior(); });
  std::vector<std::string> texts;
  if (!untold.empty()) {
    texts.push_back(
        untold +
        ": the recording tells hardly anything of it; its sigma stays near that of the prior.");
  }
  if (!astray.empty()) {
    texts.push_back(
        astray +
        ": the recording tells hardly anything of it, yet it went further than 3 sigmas of its "
        "prior: something else is taken for it. Do not believe the value.");
  }
  return texts;
}

const BlockHistory* find_block(const RunData& data, std::string_view name) {
  const auto found =
      std::find_if(data.blocks.begin(), data.blocks.end(),
                   [&](const BlockHistory& block) { return block.slow.block.name == name; });
  return found == data.blocks.end() ? nullptr : &*found;
}

}  // namespace

Section calibration_section(const RunData& data, const std::string& subtitle) {
  Section section{"Calibration"};
  std::vector<ShownRow> all;
  for (const FigureLook& look : figure_looks(data)) {
    std::vector<ShownRow> rows;
    for (const BlockLook& block : look.blocks) {
      if (const BlockHistory* found = find_block(data, block.name)) add_rows(*found, block, rows);
    }
    if (rows.empty()) continue;
    section.figures.push_back(rows_figure(data, look, rows, subtitle));
    all.insert(all.end(), rows.begin(), rows.end());
  }
  if (all.empty()) return section;
  section.paragraphs = untold_texts(all);
  section.tables.push_back(calibration_table(all));
  return section;
}

}  // namespace foucault::content
