#pragma once

#include <string>
#include <vector>

#include "foucault/plot/figure.h"

/// Axes and series that figures share.
namespace foucault::content {

plot::Axis time_axis();

plot::Series line(const std::string& label, plot::Ink ink, std::vector<double> x,
                  std::vector<double> y);
plot::Series points(const std::string& label, plot::Ink ink, double size, std::vector<double> x,
                    std::vector<double> y);

/// A pale band, still without places.
plot::Series pale_band(const std::string& label, const std::string& column);
/// A stretch of a band, parted from the next one.
void add_level(double begin, double end, double lower, double upper, plot::Series& band);

/// The positive numbers that logarithmic axes have to show together.
class PositiveRange {
 public:
  void take(double value);
  void take(const std::vector<double>& values);

  bool empty() const { return !(high_ > 0); }
  /// Ends of the axis: whole powers of ten around the numbers and `room_below`, `room_above` times
  /// as much beyond them.
  void fit(plot::Axis& axis, double room_below = 1, double room_above = 1) const;

 private:
  double low_ = 0;
  double high_ = 0;
};

}  // namespace foucault::content
