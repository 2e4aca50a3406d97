#include "consistency_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "foucault/plot/text.h"
#include "run_panels.h"
#include "statistics_tables.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

std::string percent(double share) { return number_text(100 * share, 1) + " %"; }

std::string band_text(const Band& band) {
  return fmt::format("{} to {}", significant_text(band.low), significant_text(band.high));
}

// ---- words

std::string size_verdict(const SquareConsistency& nis) {
  const std::string mean = fmt::format("The mean NIS, {}, lies ", significant_text(nis.mean));
  const std::string band =
      fmt::format(" the band that holds it with 95 % if the covariances are right, {}: ",
                  band_text(nis.mean_band));
  if (nis.mean > nis.mean_band.high) {
    return mean + "above" + band +
           "innovations are larger than predicted; the sigmas of the fixes or of the IMU are too "
           "small, or the method leaves out something that matters here.";
  }
  if (nis.mean < nis.mean_band.low) {
    return mean + "below" + band +
           "innovations are smaller than predicted in the mean; the sigmas of the fixes or of the "
           "IMU are larger than they need be.";
  }
  return mean + "within" + band + "innovations are as large as predicted.";
}

std::string tail_verdict(const std::array<ResidualStatistics, 3>& innovations) {
  constexpr double kHeavy = 1;  // that of 300 Gaussian numbers has a sigma of 0.28
  double largest = 0;
  for (const ResidualStatistics& s : innovations) {
    largest = std::max(largest, s.excess_kurtosis.value_or(0));
  }
  if (largest < kHeavy) return {};
  return fmt::format(
      " Their tails are heavier than a Gaussian's (excess kurtosis up to {}): now and then they "
      "are much larger than predicted.",
      significant_text(largest, 2));
}

std::string colour_verdict(const ResidualAutocorrelation& autocorrelation) {
  constexpr double kColoured = 0.1;  // 5 % are expected; the share of 300 lags has a sigma of 1.3 %
  if (autocorrelation.lag.empty()) return {};
  const std::string outside = fmt::format(
      " {} of the lags of their autocorrelation lie outside the band of white noise (5 % are "
      "expected): ",
      percent(autocorrelation.outside_share));
  if (autocorrelation.outside_share < kColoured) return outside + "they are white.";
  return outside +
         "they are coloured, by errors of the receiver, which real ones always have, or by "
         "something that is not modelled (lever arm, time offset, gravity, too stiff biases).";
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  }
  return text;
}

struct NamedNees {
  const char* name;
  const char* panel;
  const std::optional<SquareConsistency> Consistency::*squares;
  const DecimatedTable RunData::*table;
};

constexpr std::array<NamedNees, 3> kNees{
    {{"position", "Position", &Consistency::position_nees, &RunData::position_nees},
     {"velocity", "Velocity", &Consistency::velocity_nees, &RunData::velocity_nees},
     {"attitude", "Attitude", &Consistency::attitude_nees, &RunData::attitude_nees}}};

std::string nees_verdict(const Consistency& c) {
  std::vector<std::string> above;
  std::vector<std::string> below;
  bool any = false;
  for (const NamedNees& nees : kNees) {
    const std::optional<SquareConsistency>& squares = c.*nees.squares;
    if (!squares) continue;
    any = true;
    if (squares->mean > squares->mean_band.high) above.emplace_back(nees.name);
    if (squares->mean < squares->mean_band.low) below.emplace_back(nees.name);
  }
  if (!any) return {};
  std::string text = "Against the reference: ";
  if (above.empty() && below.empty()) return text + "the mean NEES lies within its band.";
  if (!above.empty()) {
    text += "the mean NEES of " + listed(above) +
            " lies above its band, the estimator is too sure of it" + (below.empty() ? "." : "; ");
  }
  if (!below.empty()) {
    text += "the mean NEES of " + listed(below) +
            " lies below its band, the estimator is better than it says.";
  }
  return text;
}

bool is_too_careful(const Consistency& c) {
  return std::any_of(kNees.begin(), kNees.end(), [&](const NamedNees& nees) {
    const std::optional<SquareConsistency>& squares = c.*nees.squares;
    return squares && squares->mean < squares->mean_band.low;
  });
}

std::string prediction_verdict(const std::vector<PredictionConsistency>& predictions) {
  const auto outside =
      std::find_if(predictions.rbegin(), predictions.rend(),
                   [](const PredictionConsistency& p) { return !p.mean_band.holds(p.mean_nis); });
  if (predictions.empty()) return {};
  if (outside == predictions.rend()) {
    return fmt::format(
        "Fixes predicted up to {} s ahead without those in between err as much as predicted: the "
        "noise of the IMU fits over that time, too.",
        number_text(predictions.back().ahead_s, 0));
  }
  const bool above = outside->mean_nis > outside->mean_band.high;
  return fmt::format(
      "Fixes predicted {} s ahead without those in between err {} than predicted (mean NIS {}, "
      "band {}): the noise of the IMU is set too {} for outages, whatever the innovations say.",
      number_text(outside->ahead_s, 0), above ? "more" : "less",
      significant_text(outside->mean_nis), band_text(outside->mean_band),
      above ? "small" : "large");
}

std::vector<std::string> prediction_row(const PredictionConsistency& p) {
  return {number_text(p.ahead_s, 0) + " s", significant_text(p.mean_nis), band_text(p.mean_band),
          number_text(static_cast<double>(p.samples), 0)};
}

Table prediction_table(const std::vector<PredictionConsistency>& predictions) {
  Table table;
  table.title = "Predictions of fixes, none used in between";
  table.header = {"Ahead", "Mean NIS", "95 % band of the mean", "Samples"};
  for (const PredictionConsistency& p : predictions) table.rows.push_back(prediction_row(p));
  table.note =
      "Now and then a copy of the estimator drives on without fixes; those that come later are "
      "compared with its prediction by its covariance. A mean that leaves its band as the time "
      "grows tells a noise of the IMU that fits only at the rate of the fixes.";
  return table;
}

std::vector<std::string> square_row(const std::string& name, const SquareConsistency& squares) {
  return {name,
          significant_text(squares.mean),
          band_text(squares.mean_band),
          percent(squares.inside_share),
          number_text(static_cast<double>(squares.samples), 0),
          number_text(squares.effective_samples, 0)};
}

Table square_table(const Consistency& c) {
  Table table;
  table.title = "Normalized squares";
  table.header = {"",        "Mean",     "95 % band of the mean", "Inside their bounds",
                  "Samples", "Effective"};
  if (c.nis.samples > 0) table.rows.push_back(square_row("NIS of used fixes", c.nis));
  for (const NamedNees& nees : kNees) {
    if (!(c.*nees.squares)) continue;
    table.rows.push_back(square_row(std::string("NEES of ") + nees.name, *(c.*nees.squares)));
  }
  table.note = fmt::format(
      "If the covariances are right the mean is 3, and 95 % lie in the bounds {} (chi-square, 3 "
      "degrees). Errors that last tell less than their number suggests: the band of the mean is "
      "for the effective number of samples, from their autocorrelation.",
      band_text(c.single_band));
  return table;
}

std::vector<std::string> residual_row(const std::string& name, const ResidualStatistics& s) {
  return {name,
          number_text(s.mean, 3),
          number_text(s.sigma, 3),
          s.excess_kurtosis ? number_text(*s.excess_kurtosis, 2) : "–",
          percent(s.inside[0]),
          percent(s.inside[1]),
          percent(s.inside[2])};
}

Table residual_table(const Consistency& c) {
  Table table;
  table.title = "Whitened innovations";
  table.header = {"", "Mean", "σ", "Excess kurtosis", "Within 1σ", "Within 2σ", "Within 3σ"};
  for (size_t i = 0; i < c.innovations.size(); ++i) {
    table.rows.push_back(residual_row(kNed[i], c.innovations[i]));
  }
  table.rows.push_back({"N(0, 1)", "0", "1", "0", "68.3 %", "95.4 %", "99.7 %"});
  table.note =
      "Innovations divided by the symmetric root of their covariance (of axes in units of their "
      "sigmas), so that they are independent and stay what they are most like: north, east, down.";
  return table;
}

// ---- squares over time

std::string square_note(const SquareConsistency& squares) {
  return fmt::format("mean {} (95 %: {}) · {} inside", significant_text(squares.mean),
                     band_text(squares.mean_band), percent(squares.inside_share));
}

/// A logarithmic axis that shows the bounds and nine tenths of the values at least; those far out
/// become arrowheads.
Axis square_axis(const std::string& label, const std::vector<double>& values, double largest) {
  constexpr double kLowest = 0.03;  // 0.15 % of chi-square with 3 degrees lie below
  constexpr double kHighest = 1e3;
  Axis axis{label, {}, AxisKind::log};
  axis.min = std::min(kLowest, 0.7 * positive_quantile(values, 0.01).value_or(kLowest));
  axis.max = 1.5 * std::max(std::clamp(largest, 20.0, kHighest),
                            positive_quantile(values, 0.9).value_or(0));
  return axis;
}

Series running_mean_band(const DecimatedTable::Rows& rows, const Band& band) {
  Series series =
      pale_band(fmt::format("95 % for the mean of {}", kRunningMeanFixes), "running mean 95 %");
  series.x = {rows.x.front(), rows.x.back()};
  series.lower = {band.low, band.low};
  series.upper = {band.high, band.high};
  return series;
}

Panel nis_panel(const RunData& data, const Consistency& c) {
  const DecimatedTable::Rows used = data.nis.rows();
  const DecimatedTable::Rows rejected = data.rejected_nis.rows();
  const double largest =
      std::max(largest_finite(used.columns[0]), largest_finite(rejected.columns[0]));
  Panel panel = time_panel(data, square_axis("NIS", used.columns[0], largest));
  if (!used.x.empty()) panel.series.push_back(running_mean_band(used, c.running_mean_band));
  panel.series.push_back(points("used", Ink::blue, 2.4, used.x, used.columns[0]));
  panel.series.back().column = "NIS";
  panel.series.push_back(line(fmt::format("mean of {} used fixes", kRunningMeanFixes), Ink::black,
                              used.x, used.columns[1]));
  panel.series.back().column = "NIS running mean";
  panel.series.back().size = 1.6;
  if (!rejected.x.empty()) {
    panel.series.push_back(
        points(data.not_used_name(), Ink::vermillion, 5, rejected.x, rejected.columns[0]));
    panel.series.back().column = "NIS rejected";
    panel.series.back().shape = Shape::cross;
  }
  add_bounds(c.single_band, "95 % for one fix", used.x, panel);
  if (c.nis.samples > 0) panel.note = square_note(c.nis) + since(data.statistics_from());
  return panel;
}

std::optional<Figure> nis_figure(const RunData& data, const Consistency& c,
                                 const std::string& subtitle) {
  if (data.nis.empty() && data.rejected_nis.empty()) return std::nullopt;
  Figure figure{
      "nis", "Normalized innovation squared (NIS)", subtitle,
      fmt::format(
          "Innovation of each fix, squared by its covariance: chi-square of three degrees if that "
          "is right. 95 % of the used fixes then lie between the dashed lines, and 95 % of the "
          "means of {} in the band, if they are independent. A level above means sigmas too small, "
          "below too large; patterns in time mean errors that are not modelled.{}",
          kRunningMeanFixes, data.is_smoothed() ? " Innovations are of the run forward." : "")};
  figure.height_mm = 105;
  figure.panels = {nis_panel(data, c)};
  return figure;
}

Panel nees_panel(const RunData& data, const DecimatedTable& table, const std::string& name,
                 const std::optional<SquareConsistency>& squares, const Band& bounds) {
  const DecimatedTable::Rows rows = table.rows();
  Panel panel =
      time_panel(data, square_axis(name, rows.columns[0], largest_finite(rows.columns[0])));
  panel.series.push_back(line("NEES", Ink::blue, rows.x, rows.columns[0]));
  panel.series.back().column = "NEES " + name;
  panel.series.back().in_legend = false;
  add_bounds(bounds, "95 % if the covariances are right", rows.x, panel);
  if (squares) panel.note = square_note(*squares) + since(data.statistics_from());
  return panel;
}

std::optional<Figure> nees_figure(const RunData& data, const Consistency& c,
                                  const std::string& subtitle) {
  Figure figure =
      stacked_figure("nees", "Normalized estimation error squared (NEES)", subtitle,
                     "Error against the reference, squared by its covariance, with the bounds of "
                     "95 % (dashed). Errors last, so the curves wander and their means vary more "
                     "than those of as many independent errors would. Far above: the estimator is "
                     "too sure of itself; far below: not sure enough.");
  for (const NamedNees& nees : kNees) {
    if ((data.*nees.table).empty()) continue;
    figure.panels.push_back(
        nees_panel(data, data.*nees.table, nees.panel, c.*nees.squares, c.single_band));
  }
  if (figure.panels.empty()) return std::nullopt;
  figure.height_mm = 40 + 46 * static_cast<double>(figure.panels.size());
  return figure;
}

// ---- whitened innovations

/// Height of each bin, as two corners.
Series density(const ResidualStatistics& s, const std::string& column) {
  Series series{"whitened innovations", column + " density", Mark::band, Ink::blue};
  series.opacity = 0.55;
  const double scale = 1 / (static_cast<double>(s.samples) * ResidualHistogram::kWidth);
  for (size_t i = 0; i < ResidualHistogram::kBins; ++i) {
    const double left =
        -ResidualHistogram::kLimit + ResidualHistogram::kWidth * static_cast<double>(i);
    const double height = scale * static_cast<double>(s.histogram.counts[i]);
    for (const double x : {left, left + ResidualHistogram::kWidth}) {
      series.x.push_back(x);
      series.lower.push_back(0);
      series.upper.push_back(height);
    }
  }
  return series;
}

Series gaussian_density() {
  Series series = line("density of N(0, 1)", Ink::black, {}, {});
  series.column = "N(0 1)";
  series.size = 1.4;
  constexpr int kSteps = 100;
  for (int i = 0; i <= kSteps; ++i) {
    const double z = ResidualHistogram::kLimit * (2.0 * i / kSteps - 1);
    series.x.push_back(z);
    series.y.push_back(std::exp(-z * z / 2) / std::sqrt(2 * M_PI));
  }
  return series;
}

Panel histogram_panel(const ResidualStatistics& s, size_t axis, double top) {
  Panel panel;
  panel.title = kNed[axis];
  panel.note = fmt::format("{} ± {}", number_text(s.mean, 2), number_text(s.sigma, 2));
  if (s.histogram.outside > 0) panel.note += fmt::format(" · {} beyond", s.histogram.outside);
  panel.x = {"Whitened innovation", "σ"};
  panel.x.min = -ResidualHistogram::kLimit;
  panel.x.max = ResidualHistogram::kLimit;
  panel.y = {"Density", ""};
  panel.y.min = 0;
  panel.y.max = top;
  panel.series = {density(s, kNed[axis]), gaussian_density()};
  return panel;
}

Series lags(const ResidualAutocorrelation& a, size_t axis) {
  Series series{"autocorrelation", std::string(kNed[axis]) + " autocorrelation", Mark::bars,
                Ink::blue};
  for (size_t k = 0; k < a.lag.size(); ++k) {
    series.x.push_back(static_cast<double>(k + 1));
    series.y.push_back(a.lag[k][static_cast<Eigen::Index>(axis)]);
  }
  return series;
}

Series white_band(const ResidualAutocorrelation& a, const std::string& column) {
  Series series = pale_band("95 % of white noise", column + " white noise");
  series.x = {0.5, static_cast<double>(a.lag.size()) + 0.5};
  series.lower = {-a.white_bound, -a.white_bound};
  series.upper = {a.white_bound, a.white_bound};
  return series;
}

double share_outside(const Series& series, double bound) {
  const auto outside = std::count_if(series.y.begin(), series.y.end(),
                                     [bound](double r) { return std::abs(r) > bound; });
  return static_cast<double>(outside) / static_cast<double>(series.y.size());
}

Panel autocorrelation_panel(const ResidualAutocorrelation& a, size_t axis, const Band& range) {
  Panel panel;
  panel.x = {"Lag", "fixes"};
  panel.y = {"Autocorrelation", ""};
  panel.y.min = range.low;
  panel.y.max = range.high;
  panel.series = {white_band(a, kNed[axis]), lags(a, axis)};
  panel.note = fmt::format("{} outside · {} fixes are {} s",
                           percent(share_outside(panel.series.back(), a.white_bound)), a.lag.size(),
                           significant_text(a.interval_s * static_cast<double>(a.lag.size())));
  return panel;
}

/// One for all axes.
Band autocorrelation_range(const ResidualAutocorrelation& a) {
  Band range{-std::max(0.1, 1.3 * a.white_bound), std::max(0.3, 1.3 * a.white_bound)};
  for (const Eigen::Vector3d& lag : a.lag) {
    range.low = std::min(range.low, 1.1 * lag.minCoeff());
    range.high = std::max(range.high, 1.1 * lag.maxCoeff());
  }
  return range;
}

double highest_density(const std::array<ResidualStatistics, 3>& innovations) {
  double highest = 0.4;
  for (const ResidualStatistics& s : innovations) {
    const int64_t most = *std::max_element(s.histogram.counts.begin(), s.histogram.counts.end());
    highest = std::max(highest, static_cast<double>(most) /
                                    (static_cast<double>(s.samples) * ResidualHistogram::kWidth));
  }
  return highest;
}

std::optional<Figure> whiteness_figure(const Consistency& c, const std::string& subtitle) {
  if (c.innovations[0].samples == 0) return std::nullopt;
  Figure figure{"innovation_whiteness", "Whitened innovations: distribution and autocorrelation",
                subtitle,
                "Above: histogram of the innovations in units of their predicted sigmas, mean ± "
                "standard deviation at the right (beyond: how many lie outside of the axis); a "
                "flatter one than N(0, 1) means sigmas too small, a steeper one too large. Below: "
                "their autocorrelation over the lag. That of white noise lies in the band at 95 % "
                "of the lags; a slow decay means errors that last from fix to fix."};
  figure.columns = 3;
  const double top = 1.08 * highest_density(c.innovations);
  for (size_t i = 0; i < 3; ++i) {
    figure.panels.push_back(histogram_panel(c.innovations[i], i, top));
  }
  figure.height_mm = 90;
  if (c.autocorrelation.lag.empty()) return figure;
  const Band range = autocorrelation_range(c.autocorrelation);
  for (size_t i = 0; i < 3; ++i) {
    figure.panels.push_back(autocorrelation_panel(c.autocorrelation, i, range));
  }
  figure.height_mm = 148;
  return figure;
}

}  // namespace

Section consistency_section(const RunData& data, const std::string& subtitle) {
  Section section{"Consistency"};
  if (!data.consistency) return section;
  const Consistency& c = *data.consistency;
  if (c.nis.samples > 0) {
    section.paragraphs.push_back(size_verdict(c.nis) + tail_verdict(c.innovations) +
                                 colour_verdict(c.autocorrelation));
  }
  std::string against_reference = nees_verdict(c);
  if (c.attitude_nees && c.attitude_nees->mean > c.attitude_nees->mean_band.high &&
      !error_words(data).empty()) {
    against_reference +=
        " That of the attitude counts the constant angle that is named under Errors, too.";
  }
  if (is_too_careful(c) && !data.blocks.empty()) {
    against_reference +=
        " It must be where what is calibrated was told truer than its prior allows for, as a lever "
        "arm of a simulation that is told exactly.";
  }
  if (!against_reference.empty()) section.paragraphs.push_back(against_reference);
  if (c.nis.samples > 0 || c.position_nees) section.tables.push_back(square_table(c));
  if (!c.predictions.empty()) {
    section.paragraphs.push_back(prediction_verdict(c.predictions));
    section.tables.push_back(prediction_table(c.predictions));
  }
  if (c.innovations[0].samples > 0) section.tables.push_back(residual_table(c));
  for (const std::optional<Figure>& figure :
       {nis_figure(data, c, subtitle), whiteness_figure(c, subtitle),
        nees_figure(data, c, subtitle)}) {
    if (figure) section.figures.push_back(*figure);
  }
  return section;
}

}  // namespace foucault::content
