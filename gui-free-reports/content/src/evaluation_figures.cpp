#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "foucault/content/evaluation_report.h"
#include "foucault/core/median.h"
#include "foucault/plot/text.h"
#include "map_unit.h"
#include "method_look.h"
#include "series.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

constexpr size_t kGrowthPoints = 60;
constexpr size_t kMostCurves = 120;  // in a panel

/// Solid lines are thick, so that those over them leave both to be seen.
Series method_series(const std::string& method, const MethodOrder& order) {
  const MethodLook look = look_of(method, order);
  Series series;
  series.label = method;
  series.ink = look.ink;
  series.size = look.dash == Dash::none ? 2.2 : 1.7;
  series.dash = look.dash;
  series.shape = look.shape;
  return series;
}

/// Broken lines over unbroken ones, so that lines that coincide are both seen.
void solid_first(std::vector<Series>& lines) {
  std::stable_partition(lines.begin(), lines.end(),
                        [](const Series& line) { return line.dash == Dash::none; });
}

/// Lower-case letters, digits and '_' of a name, for files.
std::string file_part(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool keep = std::isalnum(static_cast<unsigned char>(c)) != 0;
    result += keep ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : '_';
  }
  return result;
}

/// A direction in which outages drift.
struct Component {
  const char* name;
  std::vector<double> OutageCurve::*values;
  double OutageCurve::*maximum;
};

constexpr std::array<Component, 2> kComponents{
    {{"Horizontal", &OutageCurve::horizontal_m, &OutageCurve::max_horizontal_m},
     {"Vertical", &OutageCurve::vertical_m, &OutageCurve::max_vertical_m}}};

/// Linear between samples; NaN outside of them.
double value_at(const OutageCurve& curve, const Component& component, double t) {
  const std::vector<double>& times = curve.since_begin_s;
  const std::vector<double>& values = curve.*component.values;
  const auto after = std::lower_bound(times.begin(), times.end(), t);
  if (after == times.end()) return kNoValue;
  const auto i = static_cast<size_t>(after - times.begin());
  if (i == 0) return times[0] == t ? values[0] : kNoValue;
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return values[i - 1] + share * (values[i] - values[i - 1]);
}

double longest(const MethodCurves& curves) {
  double length = 0;
  for (const OutageCurve& curve : curves.outages) {
    if (!curve.since_begin_s.empty()) length = std::max(length, curve.since_begin_s.back());
  }
  return length;
}

/// Root mean square over the outages that last until t.
double rms_at(const MethodCurves& curves, const Component& component, double t) {
  double sum = 0;
  size_t count = 0;
  for (const OutageCurve& curve : curves.outages) {
    const double value = value_at(curve, component, t);
    if (!std::isfinite(value)) continue;
    sum += value * value;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : kNoValue;
}

void fill_rms(const MethodCurves& curves, const Component& component,
              const std::vector<double>& times, Series& series) {
  for (const double t : times) {
    series.x.push_back(t);
    series.y.push_back(rms_at(curves, component, t));
  }
}

/// Of the outages that last until t.
double median_at(const MethodCurves& curves, const Component& component, double t) {
  std::vector<double> values;
  for (const OutageCurve& curve : curves.outages) {
    const double value = value_at(curve, component, t);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values.empty() ? kNoValue : median(values);
}

std::vector<double> even_times(double length) {
  std::vector<double> times;
  for (size_t i = 0; i <= kGrowthPoints; ++i) {
    times.push_back(length * static_cast<double>(i) / kGrowthPoints);
  }
  return times;
}

/// All outages, or as many as can be told apart: evenly in the order of their drift, the smallest
/// and the largest among them.
std::vector<const OutageCurve*> shown_curves(const MethodCurves& curves,
                                             double OutageCurve::*maximum) {
  std::vector<const OutageCurve*> all;
  for (const OutageCurve& curve : curves.outages) all.push_back(&curve);
  if (all.size() <= kMostCurves) return all;
  std::stable_sort(all.begin(), all.end(), [&](const OutageCurve* a, const OutageCurve* b) {
    return a->*maximum < b->*maximum;
  });
  std::vector<const OutageCurve*> shown;
  for (size_t i = 0; i < kMostCurves; ++i) {
    shown.push_back(all[i * (all.size() - 1) / (kMostCurves - 1)]);
  }
  return shown;
}

/// Outages as one series, a gap between two.
Series outage_series(const MethodCurves& curves, const Component& component, Ink ink) {
  Series series{"each outage", curves.method + " outages", Mark::line, ink};
  series.size = 0.9;
  series.opacity = 0.35;
  for (const OutageCurve* curve : shown_curves(curves, component.maximum)) {
    const std::vector<double>& times = curve->since_begin_s;
    const std::vector<double>& values = curve->*component.values;
    series.x.insert(series.x.end(), times.begin(), times.end());
    series.y.insert(series.y.end(), values.begin(), values.end());
    series.x.push_back(times.empty() ? 0 : times.back());
    series.y.push_back(kNoValue);
  }
  return series;
}

Series median_series(const MethodCurves& curves, const Component& component) {
  Series series = line("median of all", Ink::black, even_times(longest(curves)), {});
  series.column = curves.method + " median";
  series.size = 1.4;
  series.dash = Dash::dashes;
  for (const double t : series.x) series.y.push_back(median_at(curves, component, t));
  return series;
}

double largest(const DriftCase& drift_case, double OutageCurve::*maximum) {
  double result = 0;
  for (const MethodCurves& curves : drift_case.methods) {
    for (const OutageCurve& curve : curves.outages) {
      if (std::isfinite(curve.*maximum)) result = std::max(result, curve.*maximum);
    }
  }
  return result;
}

double maximum_rms(const MethodCurves& curves, double OutageCurve::*maximum) {
  double sum = 0;
  for (const OutageCurve& curve : curves.outages) sum += std::pow(curve.*maximum, 2);
  return std::sqrt(sum / std::max<double>(1, static_cast<double>(curves.outages.size())));
}

Panel curve_panel(const MethodCurves& curves, const MethodOrder& order, const Component& component,
                  double top) {
  Series rms = method_series(curves.method, order);
  rms.dash = Dash::none;
  rms.size = 2.4;
  rms.column = curves.method + " rms";
  rms.label = "RMS of all";
  fill_rms(curves, component, even_times(longest(curves)), rms);

  Panel panel;
  panel.x = {"Time in outage", "s"};
  panel.x.min = 0;
  panel.y = {component.name, "m"};
  panel.y.min = 0;
  panel.y.max = top > 0 ? 1.06 * top : 1;
  panel.legend = LegendPlace::none;
  panel.note = fmt::format("{} m", significant_text(maximum_rms(curves, component.maximum)));
  panel.series = {outage_series(curves, component, rms.ink), rms, median_series(curves, component)};
  return panel;
}

/// Of very many outages an even choice is in the figures.
std::string outages_text(const std::string& name, size_t count, size_t all) {
  return count < all ? fmt::format("{} · {} of {} outages", name, count, all)
                     : fmt::format("{} · {} outages", name, count);
}

std::string outages_text(const DriftCase& drift_case) {
  const size_t count = drift_case.methods.empty() ? 0 : drift_case.methods[0].outages.size();
  return outages_text(drift_case.name, count, drift_case.all);
}

}  // namespace

Figure drift_curves(const DriftCase& drift_case, const MethodOrder& order) {
  Figure figure{"drift_curves_" + file_part(drift_case.name), "Drift during outages",
                outages_text(drift_case),
                "Position error from the beginning of each outage: a thin line an outage, the "
                "thick line their RMS, the broken one their median; the figure above each panel is "
                "the RMS of the maxima. Equal axes for all methods. Drift that grows evenly is "
                "normal; one line far above the "
                "rest is an outage worth a look."};
  for (const MethodCurves& curves : drift_case.methods) {
    if (curves.outages.size() <= kMostCurves) continue;
    figure.caption += fmt::format(
        " Shown are {} outages, evenly in the order of their drift; RMS and median are of all {}.",
        kMostCurves, curves.outages.size());
    break;
  }
  figure.height_mm = 165;
  figure.share_x = true;
  figure.columns = std::max(1, static_cast<int>(drift_case.methods.size()));
  for (const Component& component : kComponents) {
    const double top = largest(drift_case, component.maximum);
    for (const MethodCurves& curves : drift_case.methods) {
      figure.panels.push_back(curve_panel(curves, order, component, top));
    }
  }
  for (size_t m = 0; m < drift_case.methods.size(); ++m) {
    figure.panels[m].title = drift_case.methods[m].method;
  }
  // Beside the titles of more than four panels there is no room for the word.
  if (drift_case.methods.size() <= 4) {
    for (Panel& panel : figure.panels) panel.note = "RMS " + panel.note;
  }
  return figure;
}

namespace {

Panel maximum_panel(const DriftCase& drift_case, const MethodOrder& order,
                    const Component& component) {
  constexpr double kSmallest = 5, kRim = 2;  // [pt]
  Panel panel;
  panel.x = {"Outage", ""};
  panel.y = {component.name, "m", AxisKind::log};
  for (size_t m = 0; m < drift_case.methods.size(); ++m) {
    const MethodCurves& curves = drift_case.methods[m];
    Series series = method_series(curves.method, order);
    series.mark = Mark::points;
    // Those of methods that drift alike lie on each other: the later ones leave the earlier a rim.
    series.size = kSmallest + kRim * static_cast<double>(drift_case.methods.size() - 1 - m);
    for (size_t i = 0; i < curves.outages.size(); ++i) {
      series.x.push_back(static_cast<double>(i + 1));
      series.y.push_back(curves.outages[i].*component.maximum);
    }
    panel.series.push_back(std::move(series));
  }
  return panel;
}

}  // namespace

Figure maximum_drifts(const DriftCase& drift_case, const MethodOrder& order) {
  Figure figure{
      "maximum_drifts_" + file_part(drift_case.name), "Maximum drift of each outage",
      outages_text(drift_case),
      "The largest error within each outage, outages in order of time. Methods whose points lie on "
      "each other drift alike; the difference that matters is the one seen in nearly all outages."};
  figure.height_mm = 140;
  figure.share_x = true;
  for (const Component& component : kComponents) {
    figure.panels.push_back(maximum_panel(drift_case, order, component));
  }
  return figure;
}

namespace {

Panel distribution_panel(const DriftCase& drift_case, const MethodOrder& order,
                         const Component& component) {
  Panel panel;
  panel.x = {component.name + std::string(" maximum drift"), "m", AxisKind::log};
  panel.y = {"Share of outages", "%"};
  panel.y.min = 0;
  panel.y.max = 103;
  for (const MethodCurves& curves : drift_case.methods) {
    Series series = method_series(curves.method, order);
    series.mark = Mark::steps;
    series.column = component.name + std::string(" share ") + curves.method;
    std::vector<double> drifts;
    for (const OutageCurve& curve : curves.outages) drifts.push_back(curve.*component.maximum);
    std::sort(drifts.begin(), drifts.end());
    for (size_t i = 0; i < drifts.size(); ++i) {
      if (i == 0) {
        series.x.push_back(drifts[0]);
        series.y.push_back(0);
      }
      series.x.push_back(drifts[i]);
      series.y.push_back(100 * static_cast<double>(i + 1) / static_cast<double>(drifts.size()));
    }
    panel.series.push_back(std::move(series));
  }
  for (const double mark : {50.0, 68.0, 95.0}) {
    panel.lines.push_back(
        {Direction::horizontal, mark, number_text(mark, 0) + " %", Ink::gray, true});
  }
  return panel;
}

}  // namespace

Figure drift_distribution(const DriftCase& drift_case, const MethodOrder& order) {
  Figure figure{
      "drift_distribution_" + file_part(drift_case.name), "Distribution of the maximum drift",
      outages_text(drift_case),
      "Share of the outages whose maximum drift is at most the value on the axis. A curve further "
      "left is better; where two curves cross, neither method is better throughout."};
  figure.height_mm = 120;
  figure.columns = 2;
  for (const Component& component : kComponents) {
    figure.panels.push_back(distribution_panel(drift_case, order, component));
  }
  return figure;
}

namespace {

/// Evenly spaced on a logarithmic axis, from the first second (or a tenth) on.
std::vector<double> growth_times(double length) {
  const double first = std::min(1.0, length / 10);
  std::vector<double> times;
  for (size_t i = 0; i <= kGrowthPoints; ++i) {
    const double share = static_cast<double>(i) / kGrowthPoints;
    times.push_back(first * std::pow(length / first, share));
  }
  if (!times.empty()) times.back() = length;
  return times;
}

/// The times that tables of this field give.
Series growth_marks(const MethodCurves& curves, const MethodOrder& order,
                    const Component& component, double length) {
  Series marks = method_series(curves.method, order);
  marks.label.clear();
  marks.column = component.name + std::string(" marks ") + curves.method;
  marks.mark = Mark::points;
  marks.size = 6.5;
  std::vector<double> times;
  for (const double t : {10.0, 20.0, 30.0, 60.0}) {
    if (t <= length) times.push_back(t);
  }
  fill_rms(curves, component, times, marks);
  return marks;
}

Panel growth_panel(const DriftCase& drift_case, const MethodOrder& order,
                   const Component& component) {
  Panel panel;
  panel.x = {"Time in outage", "s", AxisKind::log};
  panel.y = {component.name + std::string(" RMS"), "m", AxisKind::log};
  std::vector<Series> marks;
  for (const MethodCurves& curves : drift_case.methods) {
    const double length = longest(curves);
    if (length <= 0) continue;
    Series series = method_series(curves.method, order);
    fill_rms(curves, component, growth_times(length), series);
    panel.series.push_back(std::move(series));
    marks.push_back(growth_marks(curves, order, component, length));
  }
  solid_first(panel.series);
  panel.series.insert(panel.series.end(), marks.begin(), marks.end());
  return panel;
}

}  // namespace

Figure drift_growth(const DriftCase& drift_case, const MethodOrder& order) {
  Figure figure{
      "drift_growth_" + file_part(drift_case.name), "Growth of the drift", outages_text(drift_case),
      "RMS over the outages against the time without GNSS, with marks at 10, 20, 30 and 60 s. The "
      "slope tells the cause: white noise "
      "of the accelerometer grows with t to the power of 1.5, a tilt or accelerometer bias with t "
      "squared, a gyroscope bias (or an Earth rate left out) with t cubed."};
  figure.height_mm = 120;
  figure.columns = 2;
  for (const Component& component : kComponents) {
    figure.panels.push_back(growth_panel(drift_case, order, component));
  }
  return figure;
}

namespace {

constexpr size_t kMostOutagePanels = 12;

/// An end of an axis about zero, a little beyond a number that holds `farthest` and has a tick at
/// it or not far below, so that a small panel has three.
double axis_end(double farthest) {
  constexpr double kMargin = 1.08;
  if (!(farthest > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(farthest)));
  for (const double round : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0}) {
    if (farthest <= round * power) return kMargin * round * power;
  }
  return kMargin * 10 * power;
}

Panel error_plane() {
  Panel panel;
  panel.x = {"East error", "m"};
  panel.y = {"North error", "m"};
  panel.equal_aspect = true;
  return panel;
}

/// How far what is drawn reaches to any side.
double farthest_of(const Panel& panel) {
  double farthest = 0;
  for (const Series& series : panel.series) {
    for (const auto* column : {&series.x, &series.y}) {
      for (const double v : *column) {
        if (std::isfinite(v)) farthest = std::max(farthest, std::abs(v));
      }
    }
  }
  return farthest;
}

/// Errors of one panel may be a hundred times those of another.
void scale_planes(Figure& figure) {
  for (Panel& panel : figure.panels) {
    const double reach = axis_end(farthest_of(panel));
    for (Axis* axis : {&panel.x, &panel.y}) {
      axis->min = -reach;
      axis->max = reach;
    }
  }
}

Series end_mark(const OutageCurve& curve, const Series& look) {
  Series mark = look;
  mark.label.clear();
  mark.column = look.label + " end";
  mark.mark = Mark::points;
  mark.size = 6;
  if (curve.east_m.empty()) return mark;
  mark.x = {curve.east_m.back()};
  mark.y = {curve.north_m.back()};
  return mark;
}

Panel outage_error_panel(const DriftCase& drift_case, const MethodOrder& order, size_t outage) {
  Panel panel = error_plane();
  panel.title = fmt::format("Outage {}", outage + 1);
  for (const MethodCurves& curves : drift_case.methods) {
    if (outage >= curves.outages.size()) continue;
    const OutageCurve& curve = curves.outages[outage];
    Series path = method_series(curves.method, order);
    path.column = fmt::format("{} outage {} north error", curves.method, outage + 1);
    path.x = curve.east_m;
    path.y = curve.north_m;
    panel.series.push_back(path);
    panel.series.push_back(end_mark(curve, path));
  }
  return panel;
}

}  // namespace

Figure outage_errors(const DriftCase& drift_case, const MethodOrder& order) {
  size_t outages = 0;
  for (const MethodCurves& c : drift_case.methods) outages = std::max(outages, c.outages.size());
  const size_t shown = std::min(outages, kMostOutagePanels);
  Figure figure{
      "outage_errors_" + file_part(drift_case.name), "The way of the error in single outages",
      outages_text(drift_case),
      fmt::format("Estimate minus truth over the ground from the beginning of an outage, "
                  "in the middle, to its end (mark), each at a scale of its own. {} of {} "
                  "outages, in order of time.",
                  shown, outages)};
  figure.columns = static_cast<int>(std::clamp<size_t>(shown, 1, 4));
  figure.height_mm = 30 + 62.0 * std::ceil(static_cast<double>(std::max<size_t>(1, shown)) / 4);
  for (size_t i = 0; i < shown; ++i) {
    figure.panels.push_back(outage_error_panel(drift_case, order, i));
  }
  scale_planes(figure);
  return figure;
}

namespace {

/// Holds 95 % of a Gaussian that spreads as these points do about their mean.
Series scatter_ellipse(const std::vector<double>& east, const std::vector<double>& north) {
  const auto count = static_cast<double>(east.size());
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(east.size()));
  for (size_t i = 0; i < east.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) << east[i], north[i];
  }
  const Eigen::Vector2d mean = points.rowwise().mean();
  const Eigen::Matrix2Xd rest = points.colwise() - mean;
  const Eigen::Matrix2d spread = rest * rest.transpose() / (count - 1);
  const Eigen::Matrix2d root =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).operatorSqrt();
  const double chi = std::sqrt(-2 * std::log(0.05));
  Series ellipse = line("95 % ellipse", Ink::gray, {}, {});
  ellipse.column = "ellipse north";
  ellipse.size = 1.6;
  for (int k = 0; k <= 72; ++k) {
    const double angle = k * M_PI / 36;
    const Eigen::Vector2d p =
        mean + chi * (root * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    ellipse.x.push_back(p.x());
    ellipse.y.push_back(p.y());
  }
  return ellipse;
}

Panel end_error_panel(const MethodCurves& curves, const MethodOrder& order) {
  Panel panel = error_plane();
  panel.title = curves.method;
  Series ends = method_series(curves.method, order);
  ends.label = "end of an outage";
  ends.in_legend = false;
  ends.column = curves.method + " end north";
  ends.mark = Mark::points;
  ends.size = 5;
  for (const OutageCurve& curve : curves.outages) {
    if (curve.east_m.empty()) continue;
    ends.x.push_back(curve.east_m.back());
    ends.y.push_back(curve.north_m.back());
  }
  if (ends.x.size() >= 3) panel.series.push_back(scatter_ellipse(ends.x, ends.y));
  panel.series.push_back(std::move(ends));
  return panel;
}

}  // namespace

Figure end_errors(const DriftCase& drift_case, const MethodOrder& order) {
  Figure figure{
      "end_errors_" + file_part(drift_case.name), "Errors at the end of the outages",
      outages_text(drift_case),
      "Estimate minus truth over the ground at the last epoch of each outage, and the "
      "ellipse that holds 95 % of a Gaussian with their mean and spread; each method at a "
      "scale of its own. A mean that is far from zero is an error that all outages "
      "have."};
  const size_t count = drift_case.methods.size();
  figure.columns = count == 4 ? 2 : static_cast<int>(std::clamp<size_t>(count, 1, 3));
  const double rows = std::ceil(static_cast<double>(count) / figure.columns);
  figure.height_mm = 30 + 85 * std::max(1.0, rows);
  for (const MethodCurves& curves : drift_case.methods) {
    figure.panels.push_back(end_error_panel(curves, order));
  }
  scale_planes(figure);
  return figure;
}

Figure ablation_bars(const std::vector<AblationBar>& bars, const MethodOrder& order) {
  Figure figure{"ablation",
                "What each part is worth",
                {},
                "RMS over the outages of the largest drift in each, with everything in use and "
                "with the part left out that is named below. A part without which the drift grows "
                "is worth having."};
  figure.height_mm = 150;
  figure.share_x = true;
  for (const auto& [label, number] : {std::pair{"Horizontal RMS", &AblationBar::horizontal_m},
                                      std::pair{"Vertical RMS", &AblationBar::vertical_m}}) {
    Panel panel;
    panel.x = {"Left out", "", AxisKind::category};
    panel.y = {label, "m"};
    panel.y.from_zero = true;
    std::map<std::string, Series> by_method;
    for (const AblationBar& bar : bars) {
      std::string name = bar.without.empty() ? "nothing" : bar.without;
      std::replace(name.begin(), name.end(), '_', ' ');
      auto& names = panel.x.categories;
      auto place = std::find(names.begin(), names.end(), name);
      if (place == names.end()) place = names.insert(names.end(), name);
      Series& series =
          by_method.try_emplace(bar.method, method_series(bar.method, order)).first->second;
      series.mark = Mark::bars;
      series.value_labels = true;
      series.x.push_back(static_cast<double>(place - names.begin()));
      series.y.push_back(bar.*number);
    }
    for (auto& [method, series] : by_method) panel.series.push_back(std::move(series));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

namespace {

std::vector<std::string> case_names(const std::vector<DriftRms>& rms) {
  std::vector<std::string> names;
  for (const DriftRms& entry : rms) {
    if (std::find(names.begin(), names.end(), entry.case_name) == names.end()) {
      names.push_back(entry.case_name);
    }
  }
  return names;
}

Panel bar_panel(const std::vector<DriftRms>& rms, const MethodOrder& order,
                Bounded DriftRms::*component, const std::string& label) {
  Panel panel;
  panel.x = {"", "", AxisKind::category};
  panel.x.categories = case_names(rms);
  panel.y = {label, "m"};
  panel.y.from_zero = true;
  for (const std::string& method : order) {
    Series series = method_series(method, order);
    series.mark = Mark::bars;
    series.value_labels = true;
    for (const DriftRms& entry : rms) {
      if (entry.method != method) continue;
      const auto place =
          std::find(panel.x.categories.begin(), panel.x.categories.end(), entry.case_name);
      const Bounded& number = entry.*component;
      series.x.push_back(static_cast<double>(place - panel.x.categories.begin()));
      series.y.push_back(number.value);
      series.lower.push_back(number.low);
      series.upper.push_back(number.high);
    }
    panel.series.push_back(std::move(series));
  }
  return panel;
}

}  // namespace

Figure drift_bars(const std::vector<DriftRms>& rms, const MethodOrder& order) {
  Figure figure{"drift_rms",
                "RMS of the maximum drift",
                {},
                "Root mean square over the outages of the largest error in each, with the 95 % "
                "bootstrap interval: the paper's Table III as a figure."};
  figure.height_mm = 165;
  figure.share_x = true;
  figure.panels = {
      bar_panel(rms, order, &DriftRms::horizontal_m, "Horizontal RMS"),
      bar_panel(rms, order, &DriftRms::vertical_m, "Vertical RMS"),
  };
  return figure;
}

namespace {

using DistanceColumn = std::vector<double> DistanceDrift::Method::*;
using DistanceNumber = Bounded DistanceDrift::Bin::*;

/// The outages behind the bins, faint.
Series outages_by_distance(const DistanceDrift::Method& method, DistanceColumn column, Ink ink) {
  Series series{{}, method.method + " outage", Mark::points, ink};
  series.size = 3.2;
  series.opacity = 0.3;
  series.range_role = RangeRole::most;
  series.x = method.distance_km;
  series.y = method.*column;
  return series;
}

/// RMS of the bins with intervals, `shift` [km] aside so that methods that agree are both seen.
Series bins_by_distance(const DistanceDrift::Method& method, DistanceNumber number, double shift,
                        const Series& look) {
  Series series = look;
  series.label.clear();
  series.column = method.method + " interval";
  series.mark = Mark::points;
  series.size = 6;
  series.dash = Dash::none;
  for (const DistanceDrift::Bin& bin : method.bins) {
    const Bounded& rms = bin.*number;
    series.x.push_back(bin.distance_km + shift);
    series.y.push_back(rms.value);
    series.lower.push_back(rms.low);
    series.upper.push_back(rms.high);
  }
  return series;
}

double farthest(const DistanceDrift& drift) {
  double result = 0;
  for (const DistanceDrift::Method& method : drift.methods) {
    for (const double d : method.distance_km) {
      if (std::isfinite(d)) result = std::max(result, d);
    }
  }
  return result;
}

Panel distance_panel(const DistanceDrift& drift, const MethodOrder& order, DistanceColumn column,
                     DistanceNumber number, const std::string& label) {
  constexpr double kShift = 0.006;  // of the axis
  Panel panel;
  panel.x = {"Distance from the start", "km"};
  panel.x.from_zero = true;
  panel.y = {label, "m", AxisKind::log};
  const double middle = 0.5 * (static_cast<double>(drift.methods.size()) - 1);
  std::vector<Series> over;
  for (size_t m = 0; m < drift.methods.size(); ++m) {
    const DistanceDrift::Method& method = drift.methods[m];
    const Series look = method_series(method.method, order);
    const double shift = kShift * farthest(drift) * (static_cast<double>(m) - middle);
    const Series bins = bins_by_distance(method, number, shift, look);
    Series line = look;
    line.column = method.method + " rms";
    line.x = bins.x;
    line.y = bins.y;
    panel.series.push_back(outages_by_distance(method, column, look.ink));
    over.push_back(std::move(line));
    over.push_back(bins);
  }
  panel.series.insert(panel.series.end(), over.begin(), over.end());
  return panel;
}

}  // namespace

Figure drift_by_distance(const DistanceDrift& drift, const MethodOrder& order) {
  const size_t outages = drift.methods.empty() ? 0 : drift.methods[0].distance_km.size();
  Figure figure{"drift_by_distance_" + file_part(drift.name),
                "Drift against distance from the start",
                outages_text(drift.name, outages, drift.all),
                "The largest drift of each outage (faint) and its root mean square over "
                "neighbouring outages with the 95 % bootstrap interval. A method that is right "
                "everywhere on Earth drifts alike at every distance."};
  figure.height_mm = 165;
  figure.share_x = true;
  figure.panels = {
      distance_panel(drift, order, &DistanceDrift::Method::horizontal_m,
                     &DistanceDrift::Bin::horizontal_m, "Horizontal"),
      distance_panel(drift, order, &DistanceDrift::Method::vertical_m,
                     &DistanceDrift::Bin::vertical_m, "Vertical"),
  };
  return figure;
}

namespace {

using NormalizedColumn = std::vector<Bounded> NormalizedErrors::Method::*;

/// The band of each time; that of the first method which has one, as all have the same outages.
Series normalized_band(const NormalizedErrors& errors, NormalizedColumn column) {
  constexpr double kHalfWidth = 0.42;  // of the place of a time
  Series band = pale_band("95 % if the sigmas are right", "band");
  for (size_t i = 0; i < errors.times.size(); ++i) {
    for (const NormalizedErrors::Method& method : errors.methods) {
      const Bounded& number = (method.*column)[i];
      if (!std::isfinite(number.low)) continue;
      const auto centre = static_cast<double>(i);
      add_level(centre - kHalfWidth, centre + kHalfWidth, number.low, number.high, band);
      break;
    }
  }
  return band;
}

Panel normalized_panel(const NormalizedErrors& errors, const MethodOrder& order,
                       NormalizedColumn column, const std::string& label) {
  constexpr double kSpread = 0.5;  // of the place of a time
  Panel panel;
  panel.title = label;
  panel.x = {"Time in outage", "", AxisKind::category};
  panel.x.categories = errors.times;
  panel.y = {"Mean square over sigma²", "", AxisKind::log};
  panel.series.push_back(normalized_band(errors, column));
  const auto count = static_cast<double>(errors.methods.size());
  for (size_t m = 0; m < errors.methods.size(); ++m) {
    const NormalizedErrors::Method& method = errors.methods[m];
    Series series = method_series(method.method, order);
    series.mark = Mark::points;
    series.size = 7;
    for (size_t i = 0; i < errors.times.size(); ++i) {
      const double shift = kSpread * ((static_cast<double>(m) + 0.5) / count - 0.5);
      series.x.push_back(static_cast<double>(i) + shift);
      series.y.push_back((method.*column)[i].value);
    }
    panel.series.push_back(std::move(series));
  }
  panel.lines.push_back({Direction::horizontal, 1, "", Ink::gray, true});
  return panel;
}

}  // namespace

Figure normalized_drift(const NormalizedErrors& errors, const MethodOrder& order) {
  Figure figure{"normalized_drift_" + file_part(errors.name), "Errors in outages over their sigmas",
                errors.name,
                "Mean over the outages of the squared error over its variance, per degree of "
                "freedom, at some times in the outage. Right sigmas give 1 (dashed), within the "
                "band with 95 %. Points that leave the band upwards with time tell a noise of the "
                "IMU that fits over a second and not over a minute."};
  figure.height_mm = 110;
  figure.columns = 2;
  figure.panels = {
      normalized_panel(errors, order, &NormalizedErrors::Method::horizontal, "Horizontal"),
      normalized_panel(errors, order, &NormalizedErrors::Method::vertical, "Vertical"),
  };
  return figure;
}

Figure error_timeline(const ErrorTimeline& timeline, const MethodOrder& order) {
  Panel panel;
  panel.x = time_axis();
  panel.y = {"Horizontal error", "m", AxisKind::log};
  for (const TimeSpan& outage : timeline.outages) {
    panel.shades.push_back({outage.begin_s, outage.end_s, "GNSS withheld", Ink::gray});
  }
  for (const ErrorTimeline::Curve& curve : timeline.curves) {
    Series series = method_series(curve.method, order);
    series.size = std::max(0.9, 2.3 - 0.6 * static_cast<double>(panel.series.size()));
    series.x = curve.t_s;
    series.y = curve.horizontal_m;
    panel.series.push_back(std::move(series));
  }
  solid_first(panel.series);
  Figure figure{"error_timeline_" + file_part(timeline.name), "Horizontal error over time",
                timeline.subtitle,
                "Horizontal position error on a logarithmic axis. It rises during outages and has "
                "to fall back at once with the first fixes after."};
  figure.height_mm = 120;
  figure.panels = {panel};
  return figure;
}

namespace {

Series path_series(const GroundPath& path, const std::string& label, Ink ink, double size) {
  Series series{label, label + " north", Mark::line, ink};
  series.size = size;
  series.x = path.east_m;
  series.y = path.north_m;
  return series;
}

}  // namespace

Figure outage_map(const OutageMap& map, const MethodOrder& order) {
  Panel panel;
  panel.x = {"East of the first estimate", "m"};
  panel.y = {"North of the first estimate", "m"};
  panel.x.least_span = panel.y.least_span = 1;
  panel.equal_aspect = true;
  panel.scale_bar = true;
  const auto places = [](const GroundPath& path) {
    return std::count_if(path.north_m.begin(), path.north_m.end(),
                         [](double v) { return std::isfinite(v); });
  };
  // Withheld fixes are a truth of the outages alone.
  if (places(map.truth) > places(map.truth_in_outages)) {
    panel.series.push_back(path_series(map.truth, "truth", Ink::light_gray, 2.2));
  }
  panel.series.push_back(path_series(map.truth_in_outages, "truth in outages", Ink::gray, 4));
  for (const OutageMap::Estimate& estimate : map.estimates) {
    const Series look = method_series(estimate.method, order);
    panel.series.push_back(path_series(estimate.path, estimate.method, look.ink, 1.6));
    panel.series.back().dash = look.dash;
  }
  choose_map_unit(panel);
  Figure figure{
      "outage_map_" + file_part(map.name), "Ground track with outages", map.subtitle,
      "The true path (light grey; wide and dark where GNSS was withheld) and the estimates during "
      "outages. The distance between the wide line and a thin one at the end of an outage is its "
      "drift."};
  figure.height_mm = 190;
  figure.panels = {panel};
  return figure;
}

Figure parameter_map(const ParameterMap& map) {
  Panel panel;
  panel.x = {map.x_label, "", AxisKind::category};
  panel.y = {map.y_label, "", AxisKind::category};
  for (const double x : map.x) panel.x.categories.push_back(fmt::format("{:g}", x));
  for (const double y : map.y) panel.y.categories.push_back(fmt::format("{:g}", y));
  panel.colour = {map.value_label, map.value_unit};
  panel.heat_map = HeatMap{map.x.size(), map.y.size(), map.values};
  if (map.chosen) {
    Series chosen = points("chosen", Ink::vermillion, 1.2, {static_cast<double>(map.chosen->first)},
                           {static_cast<double>(map.chosen->second)});
    chosen.shape = Shape::frame;
    panel.series.push_back(chosen);
  }
  Figure figure{map.name, map.title, map.subtitle,
                "The objective over two parameters, the others at their best; the frame marks the "
                "chosen point. A broad valley means that the result does not hang on the exact "
                "value; an optimum on the edge asks for a wider grid."};
  figure.height_mm = 60 + 14 * static_cast<double>(map.y.size());
  figure.width_mm = std::min(250.0, 75 + 26 * static_cast<double>(map.x.size()));
  figure.panels = {panel};
  return figure;
}

}  // namespace foucault::content
