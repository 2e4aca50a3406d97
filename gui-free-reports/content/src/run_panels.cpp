#include "run_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/plot/text.h"

namespace foucault::content {

using namespace plot;

namespace {

constexpr double kStackedHeight = 172;  // [mm], of three panels above each other

bool overlaps(const Interval& a, const std::vector<Interval>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Interval& b) { return a.begin < b.end && b.begin < a.end; });
}

}  // namespace

std::vector<Shade> time_shades(const RunData& data) {
  std::vector<Shade> shades;
  const std::vector<Interval> outages = data.outages();
  for (const Interval& outage : outages) {
    shades.push_back({outage.begin, outage.end, "GNSS withheld", Ink::gray});
  }
  for (const Interval& gap : data.fix_steps.longest_gaps()) {
    if (overlaps(gap, outages)) continue;
    shades.push_back({gap.begin, gap.end, "no usable GNSS", Ink::orange});
  }
  for (const Interval& gap : data.imu_steps.longest_gaps()) {
    shades.push_back({gap.begin, gap.end, "IMU gap", Ink::purple});
  }
  return shades;
}

Panel time_panel(const RunData& data, const Axis& y) {
  Panel panel;
  panel.x = time_axis();
  panel.y = y;
  panel.shades = time_shades(data);
  return panel;
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
    bound.dashed = true;
    bound.size = 1.4;
    panel.series.push_back(std::move(bound));
  }
}

}  // namespace foucault::content
