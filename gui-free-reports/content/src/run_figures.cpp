#include "run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "foucault/core/fix_quality.h"
#include "foucault/plot/axis_scale.h"
#include "foucault/plot/text.h"
#include "map_unit.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;

namespace {

constexpr const char* kHeading = "Heading";
constexpr const char* kSeparation = "separation";
constexpr const char* kRoll = "Roll";
constexpr Names kEuler{kRoll, "Pitch", kHeading};
constexpr Names kXyz{"x axis", "y axis", "z axis"};

std::string column_name(const char* axis, const std::string& noun) {
  return std::string(axis) + " " + noun;
}

std::string with_unit(double value, const std::string& unit) {
  return significant_text(value) + (unit == "°" ? "" : " ") + unit;
}

std::string statistics_note(double rms, double inside, const std::string& unit, double factor) {
  return fmt::format("RMS {} · {} % within 3σ", with_unit(rms * factor, unit),
                     number_text(100 * inside, 1));
}

void add_notes(const Triad& triad, Figure& figure) {
  const AxisStatistics& statistics = triad.statistics;
  const Eigen::Vector3d rms = statistics.rms();
  const Eigen::Vector3d inside = statistics.inside_3_sigma();
  for (size_t i = 0; i < 3; ++i) {
    Panel& panel = figure.panels[i];
    const auto axis = static_cast<Eigen::Index>(i);
    const std::string unit = shown_unit(panel.y);
    panel.note = statistics_note(rms[axis], inside[axis], unit, panel.y.shown_factor) +
                 since(triad.statistics_from);
  }
}

/// A figure of three components over time within their 3-sigma bounds, a panel each.
struct TriadFigure {
  Triad RunData::*triad;
  const char* name;
  const char* title;
  const char* caption;
  const char* noun;  ///< of the columns, after the name of the axis
  const char* unit;
  Names axes;
  double least_span;      ///< of the axes
  bool is_error = false;  ///< about zero, with its statistics
  /// What the caption has more of a run forward, and of a smoothed one.
  const char* of_forward = "";
  const char* of_smoothed = "";
};

constexpr std::array<TriadFigure, 3> kSolution{{
    {&RunData::position,
     "position",
     "Position",
     "North, east and height of the IMU with 3-sigma bounds, given in numbers "
     "where they are too narrow to be seen.",
     "position",
     "m",
     {"North", "East", "Height"},
     0.1,
     false,
     " Jumps at fixes after a gap are drift being corrected."},
    {&RunData::velocity, "velocity", "Velocity",
     "Velocity in the local north-east-down with 3-sigma bounds. It "
     "should be smooth, and zero when the vehicle stands.",
     "velocity", "m/s", kNed, 0.1},
    {&RunData::attitude, "attitude", "Attitude of the vehicle",
     "Roll, pitch and heading of the vehicle with 3-sigma bounds; the "
     "lines are broken where the heading passes north and the roll half a turn.",
     "angle", "°", kEuler, 0.5, false,
     " Heading is learnt while the vehicle accelerates and turns, so its bounds narrow then.",
     " What a turn tells of the heading holds before it, too: bounds are widest far from turns and "
     "at both ends."},
}};

constexpr std::array<TriadFigure, 1> kAids{{
    {&RunData::vehicle_velocity,
     "vehicle_velocity",
     "Velocity along the vehicle's axes",
     "Velocity of the IMU along forward, right and down of the vehicle, with the mounting that was "
     "estimated where it is, and 3-sigma bounds. Wheels that do not slip leave little to the right "
     "and down, but for turns, in which an IMU ahead of the rear axle moves sideways, and for "
     "springs.",
     "velocity",
     "m/s",
     {"Forward", "Right", "Down"},
     0.1},
}};

constexpr std::array<TriadFigure, 3> kErrors{{
    {&RunData::position_error, "position_error", "Position error against the reference",
     "Estimate minus reference. If the estimator knows its own accuracy, 99.7 % of the errors lie "
     "within the bounds; bounds that are never touched are too wide.",
     "error", "m", kNed, 0, true},
    {&RunData::velocity_error, "velocity_error", "Velocity error against the reference",
     "Estimate minus reference, local north-east-down, with 3-sigma bounds.", "error", "m/s", kNed,
     0, true},
    {&RunData::attitude_error, "attitude_error", "Attitude error against the reference",
     "Estimate minus reference, vehicle axes, with 3-sigma bounds. "
     "A constant offset points at a mounting angle.",
     "error", "°", kEuler, 0, true,
     " Roll and pitch settle within seconds, the heading as the vehicle manoeuvres."},
}};

constexpr std::array<TriadFigure, 3> kSeparations{{
    {&RunData::position_separation, "position_separation", "Position, smoothed less forward",
     "What the fixes that came later changed. The bounds are what they may change: the sigmas of "
     "the forward run less those of the smoothed one, squared, which end at the last fix. Beyond "
     "the bounds, the forward run thought itself better than it was: a fix was wrong, or it had "
     "taken for known what came out otherwise (a lever arm, a scale).",
     kSeparation, "m", kNed, 0, true},
    {&RunData::velocity_separation, "velocity_separation", "Velocity, smoothed less forward",
     "What the fixes that came later changed, local north-east-down, with 3-sigma bounds.",
     kSeparation, "m/s", kNed, 0, true},
    {&RunData::attitude_separation, "attitude_separation", "Attitude, smoothed less forward",
     "What the fixes that came later changed, vehicle axes, with 3-sigma bounds. The heading is "
     "what a forward run learns last.",
     kSeparation, "°", kEuler, 0, true},
}};

constexpr std::array<TriadFigure, 2> kBiases{{
    {&RunData::gyro_bias, "gyro_bias", "Gyroscope bias",
     "Bias on the axes of the IMU with 3-sigma bounds.", "bias", "°/h", kXyz, 1, false,
     " After the first manoeuvres it should move slowly, within the bounds it had before.",
     " It should move slowly; steps are of something else, taken for a bias."},
    {&RunData::accel_bias, "accel_bias", "Accelerometer bias",
     "Bias on the axes of the IMU with 3-sigma bounds (1 mGal = 10⁻⁵ m/s²). The "
     "horizontal axes are told from tilt only while the vehicle turns.",
     "bias", "mGal", kXyz, 10},
}};

/// One number over time with its sigma.
struct Curve {
  std::vector<double> t, value, sigma;

  void add(double at, double number, double deviation) {
    t.push_back(at);
    value.push_back(number);
    sigma.push_back(deviation);
  }
};

/// From the place of one number to the next, over north: to that end of 0 to 360, and on from the
/// other one.
void pass_north(const Curve& angle, size_t i, Curve& result) {
  const double from = angle.value[i - 1];
  const double to = angle.value[i];
  const double north = 360 * std::max(std::floor(from / 360), std::floor(to / 360));
  const double at = angle.t[i - 1] + (angle.t[i] - angle.t[i - 1]) * (north - from) / (to - from);
  result.add(at, to > from ? 360 : 0, angle.sigma[i]);
  result.add(at, kNoValue, kNoValue);
  result.add(at, to > from ? 0 : 360, angle.sigma[i]);
}

/// A continuous angle [deg] as 0 to 360.
Curve on_circle(const Curve& angle) {
  Curve result;
  for (size_t i = 0; i < angle.t.size(); ++i) {
    const double turns = std::floor(angle.value[i] / 360);
    const bool passes = i > 0 && std::isfinite(turns) && std::isfinite(angle.value[i - 1]) &&
                        std::floor(angle.value[i - 1] / 360) != turns;
    if (passes) pass_north(angle, i, result);
    result.add(angle.t[i], angle.value[i] - 360 * turns, angle.sigma[i]);
  }
  return result;
}

/// A wrapped angle [deg] whose line breaks where it passes half a turn.
Curve broken_at_half_turns(const Curve& angle) {
  Curve result;
  for (size_t i = 0; i < angle.t.size(); ++i) {
    if (i > 0 && std::abs(angle.value[i] - angle.value[i - 1]) > 180) {
      result.add(angle.t[i], kNoValue, kNoValue);
    }
    result.add(angle.t[i], angle.value[i], angle.sigma[i]);
  }
  return result;
}

/// All of it where the line breaks; where it does not, what there is.
void show_half_turns(const Curve& curve, size_t continuous, Axis& axis) {
  if (curve.t.size() == continuous) return;
  axis.kind = AxisKind::bearing;
  axis.min = -180;
  axis.max = 180;
}

void show_bearing(const Curve& curve, size_t continuous, Axis& axis) {
  axis.kind = AxisKind::bearing;
  if (curve.t.size() == continuous) return;  // never over north
  axis.min = 0;
  axis.max = 360;
}

/// Of separations the line tells; bounds that were wide before a forward run knew better would make
/// it a flat one.
void leave_room_for_line(Panel& panel) {
  constexpr double kWidest = 4;  // of bounds, in the largest number of the line
  const std::vector<double>& values = panel.series.back().y;
  double largest = 0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  if (!(largest > 0) || y_span(panel).max <= kWidest * largest) return;
  panel.y.min = -kWidest * largest;
  panel.y.max = kWidest * largest;
}

Panel triad_panel(const RunData& data, const TriadFigure& look, const DecimatedTable::Rows& rows,
                  size_t axis) {
  Curve curve{rows.x, rows.columns[axis], rows.columns[axis + 3]};
  Panel panel = time_panel(data, {look.axes[axis], look.unit});
  if (look.axes[axis] == kHeading && !look.is_error) {
    curve = on_circle(curve);
    show_bearing(curve, rows.x.size(), panel.y);
  } else if (look.axes[axis] == kRoll && !look.is_error) {
    curve = broken_at_half_turns(curve);
    show_half_turns(curve, rows.x.size(), panel.y);
  }
  const std::string column = column_name(look.axes[axis], look.noun);
  const std::vector<double> zero(curve.t.size(), 0);
  panel.y.zero_centred = look.is_error;
  panel.y.least_span = look.least_span;
  panel.series = {
      bounds(curve.t, look.is_error ? zero : curve.value, curve.sigma, column + " 3 sigma"),
      line(look.is_error ? look.noun : "estimate", Ink::blue, curve.t, curve.value)};
  panel.series.back().column = column;
  // A run forward begins with bounds that would leave no room for all that comes.
  if (data.is_smoothed() && look.triad != &RunData::position_separation)
    panel.series.front().range_role = RangeRole::most;
  if (look.noun == kSeparation) leave_room_for_line(panel);
  return panel;
}

/// Its bounds, the first series, leave the axis.
bool is_cut(const Panel& panel) {
  const Span shown = y_span(panel);
  const Series& bounds = panel.series.front();
  const auto outside = [&](const std::vector<double>& edge) {
    return std::any_of(edge.begin(), edge.end(), [&](double v) {
      return std::isfinite(v) && !(v >= shown.min && v <= shown.max);
    });
  };
  return outside(bounds.lower) || outside(bounds.upper);
}

Figure triad_figure(const RunData& data, const TriadFigure& look, const std::string& subtitle) {
  const Triad& triad = data.*look.triad;
  const DecimatedTable::Rows rows = triad.rows.rows();
  Figure figure = stacked_figure(
      look.name, look.title, subtitle,
      look.caption + std::string(data.is_smoothed() ? look.of_smoothed : look.of_forward));
  for (size_t i = 0; i < 3; ++i) figure.panels.push_back(triad_panel(data, look, rows, i));
  if (look.is_error) add_notes(triad, figure);
  bool any_cut = false;
  for (size_t i = 0; i < 3; ++i) {
    const bool cut = is_cut(figure.panels[i]);
    tell_hidden_bounds(rows.columns[i + 3], cut, figure.panels[i]);
    any_cut = any_cut || cut;
  }
  if (any_cut) {
    figure.caption += " Bounds wider than the axes are cut.";
  }
  return figure;
}

template <size_t N>
std::vector<Figure> triad_figures(const RunData& data, const std::array<TriadFigure, N>& looks,
                                  const std::string& subtitle) {
  std::vector<Figure> figures;
  for (const TriadFigure& look : looks) {
    if (!(data.*look.triad).empty()) figures.push_back(triad_figure(data, look, subtitle));
  }
  return figures;
}

/// In the order of FixQuality.
constexpr std::array<Ink, 6> kQualityInks{Ink::gray, Ink::vermillion, Ink::purple,
                                          Ink::blue, Ink::orange,     Ink::green};

/// Every fix type, in the order of its number.
std::vector<Category> quality_categories() {
  std::vector<Category> categories;
  for (size_t i = 0; i < kQualityInks.size(); ++i) {
    categories.push_back({std::string(words_of(static_cast<FixQuality>(i))), kQualityInks[i]});
  }
  return categories;
}

/// Rows of a gap are left out: points are not joined.
Series fix_points(const DecimatedTable::Rows& rows) {
  Series series{"fix", "fix north", Mark::points};
  constexpr size_t kFew = 500;
  series.size = rows.x.size() < kFew ? 3.4 : 1.9;  // to be seen beside the line, and apart
  series.categories = quality_categories();
  series.x = rows.columns[1];
  series.y = rows.columns[0];
  series.category = rows.columns[2];
  return series;
}

Series mark_at(double x, double y, const std::string& label, Shape shape, double size) {
  Series mark = points(label, Ink::black, size, {x}, {y});
  mark.shape = shape;
  mark.in_legend = false;
  return mark;
}

/// The side of an end of the track that the track does not leave to: it leaves to where its first
/// point is that is `distance` away, seen from that end.
template <class Iterator>
Side free_side(Iterator x, Iterator x_end, double distance) {
  const double at = *x;
  const Iterator away =
      std::find_if(x, x_end, [&](double value) { return std::abs(value - at) > distance; });
  return away == x_end || *away > at ? Side::left : Side::right;
}

/// Marks where the track starts and ends; one label if that is the same place.
void mark_ends(const Series& track, Panel& panel) {
  if (track.x.empty()) return;
  const double size = std::max(x_span(panel).width(), y_span(panel).width());
  const double step = 0.01 * size;
  Annotation start{track.x.front(), track.y.front(), "start",
                   free_side(track.x.begin(), track.x.end(), step), Ink::black};
  const Annotation end{track.x.back(), track.y.back(), "end",
                       free_side(track.x.rbegin(), track.x.rend(), step), Ink::black};
  panel.series.push_back(mark_at(start.x, start.y, "start", Shape::ring, 7));
  panel.series.push_back(mark_at(end.x, end.y, "end", Shape::square, 6));
  if (std::hypot(end.x - start.x, end.y - start.y) < 0.04 * size) {
    start.text = "start, end";
    panel.annotations = {start};
  } else {
    panel.annotations = {start, end};
  }
}

/// A page height that suits the shape of the track [mm].
double track_height(const Panel& panel) {
  const Span x = x_span(panel);
  const Span y = y_span(panel);
  constexpr double kWidth = 225;
  constexpr double kHead = 42;
  return std::clamp(kWidth * y.width() / x.width() + kHead, 130.0, 240.0);
}

}  // namespace

std::optional<Figure> ground_track(const RunData& data, const std::string& subtitle) {
  if (data.track.empty() && data.fix_places.empty()) return std::nullopt;
  Panel panel;
  panel.x = {fmt::format("East of the {}", data.origin()), "m"};
  panel.y = {fmt::format("North of the {}", data.origin()), "m"};
  panel.x.least_span = panel.y.least_span = 1;
  panel.equal_aspect = true;
  panel.scale_bar = true;

  const DecimatedTable::Rows track = data.track.rows();
  Series estimate = line("estimate", Ink::sky, track.columns[1], track.columns[0]);
  estimate.column = "estimate north";
  estimate.time = track.x;
  estimate.size = 4;
  estimate.opacity = 0.6;
  panel.series.push_back(estimate);
  if (!data.fix_places.empty()) panel.series.push_back(fix_points(data.fix_places.rows()));
  if (!data.rejected_places.empty()) {
    const DecimatedTable::Rows rejected = data.rejected_places.rows();
    panel.series.push_back(points(data.not_used_name() + " fix", Ink::black, 5, rejected.columns[1],
                                  rejected.columns[0]));
    panel.series.back().column = "rejected fix";
    panel.series.back().shape = Shape::cross;
    panel.series.back().range_role = RangeRole::typical;
  }
  mark_ends(estimate, panel);
  choose_map_unit(panel);

  Figure figure{"ground_track", "Ground track", subtitle,
                "The estimated path of the IMU (wide line) and the GNSS fixes of the antenna, "
                "coloured by type. In a good run the line passes through the fixes and is smooth "
                "where they are missing."};
  figure.height_mm = track_height(panel);
  figure.panels.push_back(std::move(panel));
  return figure;
}

namespace {

/// What may be told of sigmas that jump from epoch to epoch, as between fixes or standstills.
struct SigmaStep {
  double seconds = 1;
  bool thins = false;  ///< there are epochs that are closer
};

SigmaStep sigma_step(const std::vector<double>& t) {
  constexpr double kPoints = 1500;  // more than there are pixels
  SigmaStep step;
  if (t.size() < 2) return step;
  step.seconds = std::max(step.seconds, (t.back() - t.front()) / kPoints);
  step.thins = static_cast<double>(t.size()) * step.seconds > 1.5 * (t.back() - t.front());
  return step;
}

/// The largest of each step, where it is; gaps stay.
Series largest_of_steps(Series series, double step) {
  std::vector<double> x, y;
  std::optional<double> begun;
  for (size_t i = 0; i < series.x.size(); ++i) {
    const double bin = std::floor(series.x[i] / step);
    const bool same = begun && *begun == bin && std::isfinite(series.y[i]);
    begun = std::isfinite(series.y[i]) ? std::optional(bin) : std::nullopt;
    if (!same) {
      x.push_back(series.x[i]);
      y.push_back(series.y[i]);
    } else if (series.y[i] > y.back()) {
      x.back() = series.x[i];
      y.back() = series.y[i];
    }
  }
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

Panel sigma_panel(const RunData& data, const Triad& triad, const std::string& label,
                  const std::string& unit, const Names& axes) {
  const DecimatedTable::Rows rows = triad.rows.rows();
  const SigmaStep step = sigma_step(rows.x);
  Panel panel = time_panel(data, {label, unit});
  panel.y.kind = AxisKind::log;
  panel.legend = LegendPlace::panel;
  for (size_t i = 0; i < 3; ++i) {
    panel.series.push_back(line(axes[i], kTriadInks[i], rows.x, rows.columns[i + 3]));
    if (step.thins) panel.series.back() = largest_of_steps(panel.series.back(), step.seconds);
    panel.series.back().column = label + " sigma " + axes[i];
    panel.series.back().dash = kTriadDashes[i];
  }
  return panel;
}

Figure uncertainty_figure(const RunData& data, const std::string& subtitle) {
  Figure figure = stacked_figure(
      "uncertainty", "Estimated uncertainty (1σ)", subtitle,
      std::string("Standard deviations the estimator gives itself, on logarithmic axes. ") +
          (data.is_smoothed() ? "They are largest in the middle of a stretch without GNSS, for "
                                "fixes before and after it count."
                              : "They grow without GNSS and fall with the first fixes after."));
  const SigmaStep step = sigma_step(data.position.rows.rows().x);
  if (step.thins) {
    figure.caption +=
        fmt::format(" The largest of every {} s is drawn.", significant_text(step.seconds, 2));
  }
  figure.height_mm = 200;
  figure.panels = {
      sigma_panel(data, data.position, "Position", "m", kNed),
      sigma_panel(data, data.velocity, "Velocity", "m/s", kNed),
      sigma_panel(data, data.attitude, "Attitude", "°", kEuler),
  };
  for (Panel& panel : figure.panels) {
    for (Shade& shade : panel.shades) shade.label.clear();
  }
  return figure;
}

}  // namespace

std::vector<Figure> solution_figures(const RunData& data, const std::string& subtitle) {
  std::vector<Figure> figures = triad_figures(data, kSolution, subtitle);
  if (!data.position.empty()) figures.front().title += fmt::format(" from the {}", data.origin());
  if (!data.position.empty()) figures.push_back(uncertainty_figure(data, subtitle));
  return figures;
}

std::vector<Figure> vehicle_figures(const RunData& data, const std::string& subtitle) {
  return triad_figures(data, kAids, subtitle);
}

std::vector<Figure> error_figures(const RunData& data, const std::string& subtitle) {
  return triad_figures(data, kErrors, subtitle);
}

std::vector<Figure> separation_figures(const RunData& data, const std::string& subtitle) {
  return triad_figures(data, kSeparations, subtitle);
}

std::vector<Figure> bias_figures(const RunData& data, const std::string& subtitle) {
  return triad_figures(data, kBiases, subtitle);
}

namespace {

/// Innovation bounds of the used fixes.
Series innovation_bounds(const DecimatedTable::Rows& used, size_t axis, const std::string& column) {
  const std::vector<double> zero(used.x.size(), 0);
  Series series = bounds(used.x, zero, used.columns[axis + 3], column + " 3 sigma");
  series.label = "±3σ predicted";
  return series;
}

Panel innovation_panel(const RunData& data, const DecimatedTable::Rows& used,
                       const DecimatedTable::Rows& rejected, size_t axis) {
  const std::string column = column_name(kNed[axis], "innovation");
  Panel panel = time_panel(data, {kNed[axis], "m"});
  panel.y.zero_centred = true;
  panel.series.push_back(innovation_bounds(used, axis, column));
  panel.series.push_back(points("used", Ink::blue, 2.4, used.x, used.columns[axis]));
  panel.series.back().column = column;
  panel.series.back().range_role = RangeRole::most;
  if (rejected.x.empty()) return panel;
  panel.series.push_back(
      points(data.not_used_name(), Ink::vermillion, 5, rejected.x, rejected.columns[axis]));
  panel.series.back().column = column + " rejected";
  panel.series.back().shape = Shape::cross;
  panel.series.back().range_role = RangeRole::none;
  return panel;
}

}  // namespace

std::optional<Figure> innovation_figure(const RunData& data, const std::string& subtitle) {
  if (data.innovation.empty() && data.rejected_innovation.empty()) return std::nullopt;
  Figure figure = stacked_figure(
      "gnss_innovations", "GNSS innovations", subtitle,
      std::string("Fix minus its prediction, before it is used, with the 3-sigma bounds of the "
                  "prediction and the fix together. Good innovations are centred, have no pattern "
                  "in time and stay within the bounds. Crosses are rejected fixes; arrowheads "
                  "stand for what lies outside of the axes.") +
          (data.is_smoothed() ? " Predictions are those of the run forward." : ""));
  const DecimatedTable::Rows used = data.innovation.rows.rows();
  const DecimatedTable::Rows rejected = data.rejected_innovation.rows.rows();
  for (size_t axis = 0; axis < 3; ++axis) {
    figure.panels.push_back(innovation_panel(data, used, rejected, axis));
  }
  add_notes(data.innovation, figure);
  return figure;
}

StepFacts imu_step_facts(const RunData& data) {
  const ImuGaps gaps = data.imu_gaps();
  StepFacts facts{gaps.count, gaps.duration, data.imu_steps.longest()};
  for (const Interval& gap : gaps.longest) facts.longest = std::max(facts.longest, gap.length());
  return facts;
}

std::optional<Figure> postfit_figure(const RunData& data, const std::string& subtitle) {
  if (data.postfit.empty()) return std::nullopt;
  Figure figure = stacked_figure(
      "gnss_residuals", "GNSS residuals after use", subtitle,
      std::string(data.is_smoothed() ? "Fix minus the smoothed estimate, which has used all fixes."
                                     : "Fix minus the estimate that has used it. They are smaller "
                                       "than the innovations.") +
          " Steps or slopes mean that fixes and IMU disagree (lever arm, time offset, a biased "
          "fix).");
  const DecimatedTable::Rows rows = data.postfit.rows.rows();
  const Eigen::Vector3d rms = data.postfit.statistics.rms();
  for (size_t i = 0; i < 3; ++i) {
    Panel panel = time_panel(data, {kNed[i], "m"});
    panel.y.zero_centred = true;
    panel.series.push_back(points("residual", Ink::blue, 2.4, rows.x, rows.columns[i]));
    panel.series.back().range_role = RangeRole::most;
    panel.series.back().in_legend = false;
    figure.panels.push_back(std::move(panel));
  }
  for (size_t i = 0; i < 3; ++i) {
    const Axis& y = figure.panels[i].y;
    figure.panels[i].note =
        fmt::format("RMS {} {}",
                    significant_text(rms[static_cast<Eigen::Index>(i)] * y.shown_factor),
                    shown_unit(y)) +
        since(data.postfit.statistics_from);
  }
  return figure;
}

namespace {

std::string step_note(const StepWatch& watch, const StepFacts& facts) {
  const size_t gaps = facts.gaps;
  const size_t left_out = gaps - std::min(gaps, watch.gaps());
  std::string note = fmt::format("{} Hz · longest {} s · {} gap{}", significant_text(watch.rate()),
                                 significant_text(facts.longest), gaps, gaps == 1 ? "" : "s");
  if (left_out == gaps && gaps > 0) return note + " of samples left out";
  if (left_out > 0) note += fmt::format(", {} of them of samples left out", left_out);
  return note;
}

Panel step_panel(const RunData& data, const StepWatch& watch, const StepFacts& facts,
                 const std::string& label) {
  Panel panel = time_panel(data, {label, "s"});
  const DecimatedTable::Rows rows = watch.steps().rows();
  panel.series.push_back(line(label, Ink::blue, rows.x, rows.columns[0]));
  panel.series.back().mark = Mark::steps;
  panel.series.back().size = 0.9;
  panel.series.back().in_legend = false;
  panel.note = step_note(watch, facts);
  if (watch.longest() * watch.rate() > 20) {
    panel.y.kind = AxisKind::log;
  } else if (watch.longest() < 0.5) {
    panel.y.shown_unit = "ms";
    panel.y.shown_factor = 1000;
    panel.y.from_zero = true;
  } else {
    panel.y.from_zero = true;
  }
  return panel;
}

/// A row a fix type that occurs, best at the top, and a row for rejected fixes.
Panel type_panel(const RunData& data) {
  Panel panel = time_panel(data, {});
  panel.y.kind = AxisKind::category;
  Lane not_used{data.not_used_name(), "rejected", Ink::black};
  for (const auto& [verdict, stretches] : data.verdict_stretches) {
    if (verdict == state::FixVerdict::used) continue;
    for (const Interval& each : stretches.intervals()) not_used.intervals.push_back(each);
  }
  if (!not_used.intervals.empty()) add_lane(not_used, panel);
  for (const auto& [quality, stretches] : data.quality_stretches) {
    const std::string name(words_of(quality));
    add_lane({name, name, kQualityInks[static_cast<size_t>(quality)], stretches.intervals()},
             panel);
  }
  return panel;
}

}  // namespace

std::optional<Figure> data_health_figure(const RunData& data, const std::string& subtitle) {
  Figure figure = stacked_figure(
      "data_health", "Data health", subtitle,
      "Time between IMU samples, time between GNSS fixes that were used, and fix types over time. "
      "Healthy intervals lie on one level; every gap stands out above it.");
  if (data.imu_steps.stamps() > 1) {
    figure.panels.push_back(step_panel(data, data.imu_steps, imu_step_facts(data), "IMU interval"));
  }
  if (data.fix_steps.stamps() > 1) {
    figure.panels.push_back(
        step_panel(data, data.fix_steps,
                   {data.fix_steps.gaps(), data.fix_steps.gap_duration(), data.fix_steps.longest()},
                   "Used-fix interval"));
  }
  if (!data.quality_stretches.empty()) {
    figure.panels.push_back(type_panel(data));
    figure.panels.back().height_share =
        0.25 + 0.15 * static_cast<double>(figure.panels.back().y.categories.size());
  }
  if (figure.panels.empty()) return std::nullopt;
  return figure;
}

}  // namespace foucault::content
