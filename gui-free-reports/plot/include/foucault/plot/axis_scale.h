#pragma once

#include <utility>
#include <vector>

#include "foucault/plot/figure.h"
#include "foucault/plot/ticks.h"

namespace foucault::plot {

struct Span {
  double min = 0;
  double max = 1;
  double width() const { return max - min; }
};

/// The ranges the axes of a panel show: what is fixed, else what the data ask for. Always finite
/// and of positive width, also for empty or constant data.
Span x_span(const Panel& panel);
Span y_span(const Panel& panel);

/// Maps numbers of an axis to pixels; `at_min` and `at_max` are the pixels of the ends.
class AxisScale {
 public:
  AxisScale(const Axis& axis, Span span, double at_min, double at_max);

  double pixel(double value) const;
  const Span& span() const { return span_; }
  bool shows(double value) const { return value >= span_.min && value <= span_.max; }

  /// About `count` labelled ticks.
  Ticks ticks(int count) const;

 private:
  const Axis* axis_;
  Span span_;
  double at_min_;
  double at_max_;
};

/// The unit that readers see.
const std::string& shown_unit(const Axis& axis);

/// "label (unit)".
std::string axis_title(const Axis& axis, const Ticks& ticks);

}  // namespace foucault::plot
