#include "foucault/plot/axis_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace foucault::plot {
namespace {

// Shares of the numbers that range roles ignore, each side.
constexpr double kTypicalShare = 0.1;
constexpr double kOutlierShare = 0.005;
constexpr double kYPadding = 0.06;    // of the range, above and below
constexpr double kBarPadding = 0.12;  // the same where numbers stand above bars

Span padded(Span span, double share, bool log) {
  if (log) {
    const double factor = std::pow(span.max / span.min, share);
    return {span.min / factor, span.max * factor};
  }
  return {span.min - share * span.width(), span.max + share * span.width()};
}

/// The quantiles `share` and 1 - share of the finite numbers; NaN if there are none.
Span middle_of(std::vector<double> values, double share) {
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
      values.end());
  if (values.empty()) return {kNoValue, kNoValue};
  const auto skip = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  const auto lower = values.begin() + skip;
  std::nth_element(values.begin(), lower, values.end());
  const double min = *lower;
  const auto upper = values.end() - 1 - skip;
  std::nth_element(values.begin(), upper, values.end());
  return {min, *upper};
}

/// The finite numbers that an axis has to show.
class Extent {
 public:
  explicit Extent(bool positive_only) : positive_only_(positive_only) {}

  void add(double value) {
    if (!std::isfinite(value) || (positive_only_ && value <= 0)) return;
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
  }
  void add(const std::vector<double>& values) {
    for (const double value : values) add(value);
  }
  /// What lies between the quantiles `share` and 1 - share.
  void add_middle(std::vector<double> values, double share) {
    const Span middle = middle_of(std::move(values), share);
    add(middle.min);
    add(middle.max);
  }
  /// What is at most half as far out again as the middle.
  void add_but_outliers(const std::vector<double>& values) {
    const Span middle = padded(middle_of(values, kOutlierShare), 0.25, false);
    for (const double value : values) {
      if (value >= middle.min && value <= middle.max) add(value);
    }
  }
  bool empty() const { return min_ > max_; }
  Span span() const { return {min_, max_}; }

 private:
  bool positive_only_;
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
};

/// A range of at least the axis' least width, never empty.
Span widened(const Axis& axis, Span span) {
  if (axis.kind == AxisKind::log) {
    return span.max > span.min * 1.01 ? span : Span{span.min / 3, span.max * 3};
  }
  const double magnitude = std::max(std::abs(span.min), std::abs(span.max));
  double least = std::max(axis.least_span, 1e-9 * magnitude);
  if (least == 0) least = 1;
  if (span.width() >= least) return span;
  const double middle = (span.min + span.max) / 2;
  return {middle - least / 2, middle + least / 2};
}

Span with_fixed_ends(const Axis& axis, Span span) {
  if (axis.min) span.min = *axis.min;
  if (axis.max) span.max = *axis.max;
  if (span.max > span.min) return span;
  if (axis.max && !axis.min) return {span.max - 1, span.max};
  return {span.min, span.min + 1};
}

Span category_span(const Axis& axis) {
  const double count = std::max<double>(1, static_cast<double>(axis.categories.size()));
  return {-0.5, count - 0.5};
}

Span automatic_span(const Axis& axis, const Extent& extent, double padding) {
  const bool log = axis.kind == AxisKind::log;
  Span span = extent.empty() ? (log ? Span{0.1, 10} : Span{0, 1}) : extent.span();
  if (axis.zero_centred) {
    const double largest = std::max(std::abs(span.min), std::abs(span.max));
    span = {-largest, largest};
  }
  if (axis.from_zero) span.min = std::min(0.0, span.min);
  span = padded(widened(axis, span), padding, log);
  if (axis.from_zero && extent.span().min >= 0) span.min = 0;
  return with_fixed_ends(axis, span);
}

void add_y(const Series& series, Extent& extent) {
  for (const std::vector<double>* column : {&series.y, &series.lower, &series.upper}) {
    if (series.range_role == RangeRole::full) extent.add(*column);
    if (series.range_role == RangeRole::most) extent.add_but_outliers(*column);
    if (series.range_role == RangeRole::typical) extent.add_middle(*column, kTypicalShare);
  }
}

bool has_bars(const Panel& panel) {
  return std::any_of(panel.series.begin(), panel.series.end(),
                     [](const Series& s) { return s.mark == Mark::bars; });
}

}  // namespace

Span x_span(const Panel& panel) {
  if (panel.x.kind == AxisKind::category) return category_span(panel.x);
  Extent extent(panel.x.kind == AxisKind::log);
  for (const Series& series : panel.series) extent.add(series.x);
  const bool is_time = panel.x.kind == AxisKind::duration;
  return automatic_span(panel.x, extent, is_time ? 0.01 : panel.equal_aspect ? kYPadding : 0.03);
}

Span y_span(const Panel& panel) {
  if (panel.y.kind == AxisKind::category) return category_span(panel.y);
  Extent extent(panel.y.kind == AxisKind::log);
  for (const Series& series : panel.series) add_y(series, extent);
  if (has_bars(panel) && panel.y.kind != AxisKind::log) extent.add(0);
  return automatic_span(panel.y, extent, has_bars(panel) ? kBarPadding : kYPadding);
}

AxisScale::AxisScale(const Axis& axis, Span span, double at_min, double at_max)
    : axis_(&axis), span_(span), at_min_(at_min), at_max_(at_max) {}

double AxisScale::pixel(double value) const {
  const double share = axis_->kind == AxisKind::log
                           ? std::log(value / span_.min) / std::log(span_.max / span_.min)
                           : (value - span_.min) / span_.width();
  return at_min_ + share * (at_max_ - at_min_);
}

Ticks AxisScale::ticks(int count) const {
  switch (axis_->kind) {
    case AxisKind::log:
      return log_ticks(span_.min, span_.max, count, axis_->unit);
    case AxisKind::duration:
      return duration_ticks(span_.min, span_.max, count);
    case AxisKind::bearing:
      return bearing_ticks(span_.min, span_.max, count);
    case AxisKind::linear:
      break;
    case AxisKind::category: {
      Ticks result;
      for (size_t i = 0; i < axis_->categories.size(); ++i) {
        result.ticks.push_back({static_cast<double>(i), axis_->categories[i]});
      }
      result.unit = axis_->unit;
      return result;
    }
  }
  return linear_ticks(span_.min, span_.max, count, axis_->shown_factor, shown_unit(*axis_));
}

const std::string& shown_unit(const Axis& axis) {
  return axis.shown_unit.empty() ? axis.unit : axis.shown_unit;
}

std::string axis_title(const Axis& axis, const Ticks& ticks) {
  std::string unit = ticks.unit;
  if (!ticks.exponent.empty()) unit = ticks.exponent + (unit.empty() ? "" : " " + unit);
  if (axis.label.empty() || unit.empty()) return axis.label + unit;
  return axis.label + " (" + unit + ")";
}

}  // namespace foucault::plot
