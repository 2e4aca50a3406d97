#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foucault/content/laboratory_report.h"
#include "method_look.h"
#include "series.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

struct QuantityText {
  const char* name;  ///< in file names
  const char* label;
  const char* unit;
};

QuantityText text_of(LabQuantity quantity) {
  switch (quantity) {
    case LabQuantity::position:
      return {"position", "Position error", "m"};
    case LabQuantity::velocity:
      return {"velocity", "Velocity error", "m/s"};
    case LabQuantity::attitude:
      break;
  }
  return {"attitude", "Attitude error", "rad"};
}

const std::vector<double>& values_of(const LabCurve& curve, LabQuantity quantity) {
  if (quantity == LabQuantity::position) return curve.position_m;
  return quantity == LabQuantity::velocity ? curve.velocity_m_s : curve.attitude_rad;
}

/// At exactly this x; NaN if there is none.
double value_exactly_at(const LabCurve& curve, LabQuantity quantity, double x) {
  const auto found = std::find(curve.x.begin(), curve.x.end(), x);
  if (found == curve.x.end()) return kNoValue;
  return values_of(curve, quantity).at(static_cast<std::size_t>(found - curve.x.begin()));
}

std::string seconds_text(double seconds) { return fmt::format("{:g} s", seconds); }

Series curve_line(const LabCurve& curve, LabQuantity quantity) {
  return line(curve.title, Ink::blue, curve.x, values_of(curve, quantity));
}

/// The methods in the colours that evaluations give them.
Series model_line(const LabCurve& curve, LabQuantity quantity) {
  Series series = curve_line(curve, quantity);
  series.ink = look_of(curve.key).ink;
  series.dash = curve.local ? Dash::dashes : Dash::none;
  series.size = curve.local ? 1.6 : 1.8;
  if (curve.key == "rough" && !curve.local) series.size = 3.2;
  if (curve.key == "full") series.size = 4;
  if (curve.key == "discretization") {
    series.ink = Ink::black;
    series.size = 1.3;
    series.dash = Dash::dashes;
  }
  return series;
}

/// Smallest and largest of several noises at each of their common places.
Series noise_band(const std::vector<LabCurve>& noises, LabQuantity quantity,
                  const std::string& title) {
  Series band{title, "noise band", Mark::band, Ink::gray};
  band.opacity = 0.28;
  if (noises.empty()) return band;
  band.x = noises.front().x;
  for (const double x : band.x) {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const LabCurve& noise : noises) {
      low = std::min(low, value_exactly_at(noise, quantity, x));
      high = std::max(high, value_exactly_at(noise, quantity, x));
    }
    band.lower.push_back(low);
    band.upper.push_back(high);
  }
  return band;
}

Series noise_line(const LabCurve& noise, LabQuantity quantity, bool dashed) {
  Series series = curve_line(noise, quantity);
  series.label = "noise of " + noise.title;
  series.ink = Ink::gray;
  series.size = 1.1;
  series.dash = dashed ? Dash::dashes : Dash::none;
  return series;
}

/// Thick ones first, so that lines that coincide are all seen. An attitude has no origin.
std::vector<Series> model_lines(const std::vector<LabCurve>& models, LabQuantity quantity) {
  std::vector<Series> lines;
  for (const LabCurve& model : models) {
    if (model.local && quantity == LabQuantity::attitude) continue;
    lines.push_back(model_line(model, quantity));
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Series& a, const Series& b) { return a.size > b.size; });
  return lines;
}

Panel model_panel(const LabMotionCurves& motion, const LabSettings& settings,
                  LabQuantity quantity) {
  Panel panel;
  panel.title = motion.title;
  panel.note = motion.note;
  panel.x = {"Duration", "s", AxisKind::log};
  panel.y = {text_of(quantity).label, text_of(quantity).unit, AxisKind::log};
  panel.series.push_back(noise_band(motion.band_noise, quantity, settings.band_title));
  for (const LabCurve& noise : motion.small_noise) {
    const bool second = panel.series.size() > 1;
    panel.series.push_back(noise_line(noise, quantity, second));
  }
  const std::vector<Series> models = model_lines(motion.models, quantity);
  panel.series.insert(panel.series.end(), models.begin(), models.end());
  return panel;
}

/// One range for all panels, in whole powers of ten.
void share_y_range(std::vector<Panel>& panels) {
  PositiveRange range;
  for (const Panel& panel : panels) {
    for (const Series& series : panel.series) {
      for (const auto* column : {&series.y, &series.lower, &series.upper}) range.take(*column);
    }
  }
  for (Panel& panel : panels) range.fit(panel.y);
}

}  // namespace

Figure model_errors(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                    LabQuantity quantity) {
  Figure figure{
      fmt::format("lab_models_{}", text_of(quantity).name),
      fmt::format("{} of preintegration", text_of(quantity).label),
      fmt::format("perfect IMU, {:g} Hz, exact initial state; RMS over intervals along a trip",
                  settings.rate_hz),
      fmt::format("{} at the end of an interval against its length, both axes logarithmic; above "
                  "each panel the speeds of the intervals and their distances from where the trip "
                  "began. Solid: the origin of w is where the trip began, as in a run; dashed: "
                  "where the interval begins. The dashed black line is the discretization of the "
                  "increments, the least that any model can reach with them. Grey: 1 sigma by the "
                  "noise of IMUs. A model whose line lies below an IMU's does not harm it.",
                  text_of(quantity).label)};
  figure.width_mm = motions.size() > 1 ? 260 : 170;
  figure.height_mm = 30 + 92 * std::ceil(static_cast<double>(motions.size()) / 2);
  figure.columns = motions.size() > 1 ? 2 : 1;
  figure.share_x = true;
  for (const LabMotionCurves& motion : motions) {
    figure.panels.push_back(model_panel(motion, settings, quantity));
  }
  share_y_range(figure.panels);
  return figure;
}

namespace {

struct MotionLook {
  Ink ink;
  Shape shape;
};

MotionLook look_of(std::size_t motion) {
  constexpr MotionLook kLooks[] = {{Ink::blue, Shape::dot},
                                   {Ink::orange, Shape::diamond},
                                   {Ink::green, Shape::square},
                                   {Ink::vermillion, Shape::triangle}};
  return kLooks[motion % std::size(kLooks)];
}

/// 1 sigma of IMUs as lines with their names at the level y: that of the largest right of its line,
/// the others left.
void add_upright_noise(const std::vector<LabCurve>& noises, LabQuantity quantity, double duration_s,
                       double y, Panel& panel) {
  double largest = 0;
  for (const LabCurve& noise : noises) {
    largest = std::max(largest, value_exactly_at(noise, quantity, duration_s));
  }
  for (const LabCurve& noise : noises) {
    const double sigma = value_exactly_at(noise, quantity, duration_s);
    panel.lines.push_back({Direction::vertical, sigma, "", Ink::gray, true});
    panel.annotations.push_back(
        {sigma, y, noise.title, sigma == largest ? Side::right : Side::left, Ink::gray});
  }
}

/// Whether leaving out a term changes the quantity by more than 0.1 % of what all terms give.
bool is_seen(const LabMotionCurves& motion, std::size_t term, const LabSettings& settings,
             LabQuantity quantity) {
  return std::any_of(
      settings.dot_durations_s.begin(), settings.dot_durations_s.end(), [&](double duration_s) {
        const double all = value_exactly_at(motion.ablations[0], quantity, duration_s);
        const double without = value_exactly_at(motion.ablations[term], quantity, duration_s);
        return std::abs(without - all) > 1e-3 * all;
      });
}

/// The motions with only those terms that count for the quantity in some motion, and the first.
std::vector<LabMotionCurves> with_seen_terms(const std::vector<LabMotionCurves>& motions,
                                             const LabSettings& settings, LabQuantity quantity) {
  std::vector<LabMotionCurves> result = motions;
  for (LabMotionCurves& motion : result) motion.ablations.clear();
  for (std::size_t term = 0; term < motions.front().ablations.size(); ++term) {
    const bool seen = std::any_of(motions.begin(), motions.end(), [&](const LabMotionCurves& m) {
      return is_seen(m, term, settings, quantity);
    });
    if (term > 0 && !seen) continue;
    for (std::size_t m = 0; m < motions.size(); ++m) {
      result[m].ablations.push_back(motions[m].ablations[term]);
    }
  }
  return result;
}

/// Whole powers of ten around all marks and lines, with room for a name on the right.
void fit_x_range(Panel& panel) {
  PositiveRange range;
  for (const Series& series : panel.series) range.take(series.x);
  for (const ReferenceLine& line : panel.lines) range.take(line.at);
  for (const Shade& shade : panel.shades) range.take(shade.end);
  range.fit(panel.x, 1.5, 30);
}

/// Terms from top to bottom: the first one highest.
Panel dots_panel(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                 LabQuantity quantity, double duration_s) {
  Panel panel;
  panel.title = "After " + seconds_text(duration_s);
  panel.x = {text_of(quantity).label, text_of(quantity).unit, AxisKind::log};
  panel.y.kind = AxisKind::category;
  const std::vector<LabCurve>& terms = motions.front().ablations;
  for (auto term = terms.rbegin(); term != terms.rend(); ++term) {
    panel.y.categories.push_back(term->title);
  }
  for (std::size_t m = 0; m < motions.size(); ++m) {
    Series series;
    series.label = motions[m].title;
    series.column = fmt::format("{} {}", motions[m].title, seconds_text(duration_s));
    series.mark = Mark::points;
    series.ink = look_of(m).ink;
    series.shape = look_of(m).shape;
    series.size = 8;
    series.opacity = 0.9;
    const double aside =
        0.15 * (0.5 * static_cast<double>(motions.size() - 1) - static_cast<double>(m));
    for (std::size_t i = 0; i < motions[m].ablations.size(); ++i) {
      series.x.push_back(value_exactly_at(motions[m].ablations[i], quantity, duration_s));
      series.y.push_back(static_cast<double>(terms.size() - 1 - i) + aside);
    }
    panel.series.push_back(std::move(series));
  }
  const LabMotionCurves& first = motions.front();
  const Series band = noise_band(first.band_noise, quantity, settings.band_title);
  for (std::size_t i = 0; i < band.x.size(); ++i) {
    if (band.x[i] != duration_s) continue;
    panel.shades.push_back({band.lower[i], band.upper[i], settings.band_title, Ink::gray});
  }
  add_upright_noise(first.small_noise, quantity, duration_s,
                    static_cast<double>(terms.size()) - 0.6, panel);
  fit_x_range(panel);
  return panel;
}

}  // namespace

Figure ablation_dots(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                     LabQuantity quantity) {
  Figure figure{
      fmt::format("lab_terms_{}", text_of(quantity).name),
      fmt::format("{} without one term", text_of(quantity).label),
      fmt::format("full without the term named, {:g} Hz", settings.rate_hz),
      "Error of an integration that has all that `full` has, and of the same without one term. A "
      "term whose marks lie where those of the first row do does not count there. A term matters "
      "for an IMU if its marks lie right of that IMU's noise (grey)."};
  const std::vector<LabMotionCurves> shown = with_seen_terms(motions, settings, quantity);
  figure.width_mm = 260;
  figure.height_mm = 42 + 11 * static_cast<double>(shown.front().ablations.size());
  figure.columns = static_cast<int>(settings.dot_durations_s.size());
  for (const double duration_s : settings.dot_durations_s) {
    figure.panels.push_back(dots_panel(shown, settings, quantity, duration_s));
  }
  return figure;
}

namespace {

/// 1 sigma of IMUs as level band and lines over the range of x, at one duration.
void add_level_noise(const LabMotionCurves& motion, const LabSettings& settings,
                     LabQuantity quantity, double duration_s, double x_min, double x_max,
                     Panel& panel) {
  Series band = noise_band(motion.band_noise, quantity, settings.band_title);
  const auto found = std::find(band.x.begin(), band.x.end(), duration_s);
  if (found != band.x.end()) {
    const auto i = static_cast<std::size_t>(found - band.x.begin());
    band.lower = {band.lower[i], band.lower[i]};
    band.upper = {band.upper[i], band.upper[i]};
    band.x = {x_min, x_max};
    panel.series.push_back(band);
  }
  for (const LabCurve& noise : motion.small_noise) {
    panel.lines.push_back({Direction::horizontal, value_exactly_at(noise, quantity, duration_s),
                           noise.title, Ink::gray, true});
  }
}

Series motion_line(const LabCurve& curve, LabQuantity quantity, std::size_t motion) {
  Series series = curve_line(curve, quantity);
  series.ink = look_of(motion).ink;
  series.size = 2;
  return series;
}

Panel rate_panel(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                 LabQuantity quantity) {
  constexpr std::size_t kWithMark = 0;  // of a motion's curves: the one with nothing left out
  Panel panel;
  panel.x = {"IMU rate", "Hz", AxisKind::log};
  panel.y = {text_of(quantity).label, text_of(quantity).unit, AxisKind::log};
  if (motions.front().rates.empty()) return panel;
  const std::vector<double>& rates = motions.front().rates.front().x;
  if (rates.empty()) return panel;
  add_level_noise(motions.front(), settings, quantity, settings.rates_duration_s, rates.front(),
                  rates.back(), panel);
  for (std::size_t m = 0; m < motions.size(); ++m) {
    for (std::size_t i = 0; i < motions[m].rates.size(); ++i) {
      Series series = motion_line(motions[m].rates[i], quantity, m);
      if (i != kWithMark) series.dash = Dash::dashes;
      if (i > 1) series.ink = Ink::purple;
      panel.series.push_back(series);
    }
  }
  return panel;
}

}  // namespace

Figure rate_lines(const std::vector<LabMotionCurves>& motions, const LabSettings& settings) {
  Figure figure{"lab_rates",
                fmt::format("Error of full after {} by the rate of the IMU",
                            seconds_text(settings.rates_duration_s)),
                "perfect IMU, exact initial state; RMS over intervals along a trip",
                "What is left of the error once every term is there is the motion within the "
                "samples: of second order in position, of third to fourth in attitude. A vibration "
                "needs a rate some ten times its own. Below a nanometre the truth itself ends."};
  figure.width_mm = 260;
  figure.height_mm = 130;
  figure.columns = 2;
  figure.panels = {rate_panel(motions, settings, LabQuantity::position),
                   rate_panel(motions, settings, LabQuantity::attitude)};
  return figure;
}

namespace {

Panel origin_panel(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                   std::size_t curve) {
  constexpr LabQuantity kQuantity = LabQuantity::position;
  Panel panel;
  const double duration_s = settings.dot_durations_s[curve];
  panel.title = "After " + seconds_text(duration_s);
  panel.x = {"Distance from the origin of w", "km", AxisKind::log};
  panel.y = {text_of(kQuantity).label, text_of(kQuantity).unit, AxisKind::log};
  if (motions.front().distances.size() <= curve) return panel;
  const std::vector<double>& km = motions.front().distances[curve].x;
  if (km.empty()) return panel;
  add_level_noise(motions.front(), settings, kQuantity, duration_s, km.front(), km.back(), panel);
  for (std::size_t m = 0; m < motions.size(); ++m) {
    Series series = motion_line(motions[m].distances[curve], kQuantity, m);
    series.label = motions[m].title;
    series.column = fmt::format("{} {}", motions[m].title, seconds_text(duration_s));
    if (m % 2 == 1) series.dash = Dash::dashes;
    panel.series.push_back(series);
  }
  return panel;
}

}  // namespace

Figure distance_lines(const std::vector<LabMotionCurves>& motions, const LabSettings& settings) {
  Figure figure{
      "lab_distance", "Error of refined by the distance from the origin",
      fmt::format("{:g} Hz, exact initial state; the origin lies behind the vehicle",
                  settings.rate_hz),
      "`refined` takes gravity as that of the origin of w, whose direction is off by 0.157 mrad a "
      "km: g d T^2 / 2R. An estimator takes most of it for a tilt and lives with the change along "
      "the way, the level on the left, which grows with speed. `full` and `ekf` know the place."};
  figure.width_mm = 260;
  figure.height_mm = 125;
  figure.columns = static_cast<int>(settings.dot_durations_s.size());
  for (std::size_t i = 0; i < settings.dot_durations_s.size(); ++i) {
    figure.panels.push_back(origin_panel(motions, settings, i));
  }
  return figure;
}

}  // namespace foucault::content
