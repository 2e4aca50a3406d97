#pragma once

#include <string>
#include <vector>

/// Places and texts of the ticks of an axis.
namespace foucault::plot {

struct Tick {
  double at = 0;      ///< in the unit of the numbers
  std::string label;  ///< empty: a minor tick
};

struct Ticks {
  std::vector<Tick> ticks;
  std::string unit;      ///< of the labels
  std::string exponent;  ///< e.g. "×10⁻⁵", to be shown at the end of the axis; usually empty
};

/// Round steps (1, 2, 5 times a power of ten), about `count` of them within [min, max], with as few
/// decimals as tell them apart; a common power of ten where numbers are very small or large.
/// Labels show `factor` times the place, in `unit`.
Ticks linear_ticks(double min, double max, int count, double factor = 1,
                   const std::string& unit = {});

/// Powers of ten, or 1, 2, 5 where there are few; minor ticks between. 0 < min < max.
Ticks log_ticks(double min, double max, int count, const std::string& unit = {});

/// Degrees in steps that suit a circle: 90, 45, 30 and below.
Ticks bearing_ticks(double min, double max, int count);

/// Seconds in steps that suit a clock, shown in s (up to 5 min), min (up to 5 h) or h.
Ticks duration_ticks(double min, double max, int count);

}  // namespace foucault::plot
