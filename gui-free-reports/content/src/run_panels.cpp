#include "run_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/plot/axis_scale.h"
#include "foucault/plot/text.h"

namespace foucault::content {

using namespace plot;

namespace {

constexpr double kTimeMargin = 0.01;    // of the run
constexpr double kStackedHeight = 172;  // [mm], of three panels above each other

constexpr double kReach = 0.34;  // of a bar, above and below the middle of its lane

void add_stroke(double t, double level, Series& strokes) {
  strokes.x.insert(strokes.x.end(), {t, t, t});
  strokes.y.insert(strokes.y.end(), {level - kReach, level + kReach, kNoValue});
}

bool overlaps(const Interval& a, const std::vector<Interval>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Interval& b) { return a.begin < b.end && b.begin < a.end; });
}

}  // namespace

Interval whole_run(const RunData& data) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Interval whole{kInfinity, -kInfinity};
  const auto add = [&whole](double begin, double end) {
    whole.begin = std::min(whole.begin, begin);
    whole.end = std::max(whole.end, end);
  };
  for (const StepWatch* watch : {&data.imu_steps, &data.epoch_steps}) {
    if (watch->stamps() > 0) add(watch->first(), watch->last());
  }
  for (const auto& [verdict, stretches] : data.verdict_stretches) {
    for (const Interval& interval : stretches.intervals()) add(interval.begin, interval.end);
  }
  return whole;
}

std::vector<Shade> time_shades(const RunData& data) {
  std::vector<Shade> shades;
  const std::vector<Interval> outages = data.outages();
  const bool corrects = data.verdicts.count(state::FixVerdict::corrected) > 0;
  const char* without_fixes = corrects ? "no GNSS used as it came" : "no usable GNSS";
  for (const Interval& outage : outages) {
    shades.push_back({outage.begin, outage.end, "GNSS withheld", Ink::gray});
  }
  for (const Interval& gap : data.fix_steps.longest_gaps()) {
    if (overlaps(gap, outages)) continue;
    shades.push_back({gap.begin, gap.end, without_fixes, Ink::orange});
  }
  for (const Interval& gap : data.imu_gaps().longest) {
    shades.push_back({gap.begin, gap.end, "IMU gap", Ink::purple});
  }
  return shades;
}

Panel time_panel(const RunData& data, const Axis& y) {
  Panel panel;
  panel.x = time_axis();
  const Interval whole = whole_run(data);
  if (whole.length() > 0) {
    panel.x.min = whole.begin - kTimeMargin * whole.length();
    panel.x.max = whole.end + kTimeMargin * whole.length();
  }
  panel.y = y;
  panel.shades = time_shades(data);
  return panel;
}

void add_lane(const Lane& lane, Panel& panel) {
  constexpr double kSeen = 0.002;  // of the axis
  const double least_length = kSeen * x_span(panel).width();
  const double level = static_cast<double>(panel.y.categories.size());
  panel.y.categories.push_back(lane.label);
  Series bars{{}, lane.column, Mark::band, lane.ink};
  Series strokes = line("", lane.ink, {}, {});
  strokes.column = lane.column + " moment";
  strokes.size = 1.5;
  for (const Interval& interval : lane.intervals) {
    if (interval.length() < least_length) {
      add_stroke((interval.begin + interval.end) / 2, level, strokes);
    } else {
      add_level(interval.begin, interval.end, level - kReach, level + kReach, bars);
    }
  }
  for (Series* series : {&bars, &strokes}) {
    if (!series->x.empty()) panel.series.push_back(std::move(*series));
  }
}

Figure stacked_figure(const std::string& name, const std::string& title,
                      const std::string& subtitle, const std::string& caption) {
  Figure figure{name, title, subtitle, caption};
  figure.height_mm = kStackedHeight;
  figure.share_x = true;
  return figure;
}

std::string since(double statistics_from) {
  if (statistics_from <= 0) return {};
  return fmt::format(", from {} s on", significant_text(statistics_from));
}

Series bounds(const std::vector<double>& x, const std::vector<double>& centre,
              const std::vector<double>& sigma, const std::string& column) {
  Series series = pale_band("±3σ", column);
  series.range_role = RangeRole::typical;
  series.x = x;
  for (size_t i = 0; i < x.size(); ++i) {
    series.lower.push_back(centre[i] - 3 * sigma[i]);
    series.upper.push_back(centre[i] + 3 * sigma[i]);
  }
  return series;
}

void tell_hidden_bounds(const std::vector<double>& sigma, bool cut, Panel& panel) {
  constexpr double kSeen = 1.0 / 40;  // of the axis: twice as wide as the line in its middle
  std::vector<double> finite;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(finite),
               [](double s) { return std::isfinite(s); });
  if (finite.empty()) return;
  const double seen = kSeen * y_span(panel).width() / 6;
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  if (*middle >= seen && !cut) return;
  const std::string unit = (shown_unit(panel.y) == "°" ? "" : " ") + shown_unit(panel.y);
  const auto width = [&](double s) {
    return significant_text(3 * panel.y.shown_factor * s, 2) + unit;
  };
  panel.note = joined({panel.note, fmt::format("3σ: median {}, largest {}", width(*middle),
                                               width(largest_finite(finite)))},
                      " · ");
  if (largest_finite(finite) < seen) panel.series.front().in_legend = false;
}

std::optional<double> positive_quantile(std::vector<double> values, double share) {
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](double value) { return !std::isfinite(value) || value <= 0; }),
               values.end());
  if (values.empty()) return std::nullopt;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double largest_finite(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

void add_bounds(const Band& band, const std::string& label, const std::vector<double>& x,
                Panel& panel) {
  if (x.empty()) return;
  const std::string& of = panel.title.empty() ? panel.y.label : panel.title;
  for (const auto& [at, name] : {std::pair{band.low, "2.5 %"}, std::pair{band.high, "97.5 %"}}) {
    Series bound = line(label, Ink::gray, {x.front(), x.back()}, {at, at});
    bound.column = of + " " + name;
    bound.dash = Dash::dashes;
    bound.size = 1.4;
    panel.series.push_back(std::move(bound));
  }
}

}  // namespace foucault::content
