#include "series.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace foucault::content {

using namespace plot;

Axis time_axis() { return {"Time since start", "s", AxisKind::duration}; }

Series line(const std::string& label, Ink ink, std::vector<double> x, std::vector<double> y) {
  Series series{label, {}, Mark::line, ink};
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

Series points(const std::string& label, Ink ink, double size, std::vector<double> x,
              std::vector<double> y) {
  Series series = line(label, ink, std::move(x), std::move(y));
  series.mark = Mark::points;
  series.size = size;
  return series;
}

Series pale_band(const std::string& label, const std::string& column) {
  Series band{label, column, Mark::band, Ink::sky};
  band.opacity = 0.35;
  return band;
}

void add_level(double begin, double end, double lower, double upper, Series& band) {
  band.x.insert(band.x.end(), {begin, end, end});
  band.lower.insert(band.lower.end(), {lower, lower, kNoValue});
  band.upper.insert(band.upper.end(), {upper, upper, kNoValue});
}

void PositiveRange::take(double value) {
  if (!(value > 0) || !std::isfinite(value)) return;
  low_ = empty() ? value : std::min(low_, value);
  high_ = std::max(high_, value);
}

void PositiveRange::take(const std::vector<double>& values) {
  for (const double value : values) take(value);
}

void PositiveRange::fit(Axis& axis, double room_below, double room_above) const {
  if (empty()) return;
  axis.min = std::pow(10, std::floor(std::log10(low_ / room_below)));
  axis.max = std::pow(10, std::ceil(std::log10(high_ * room_above)));
}

}  // namespace foucault::content
