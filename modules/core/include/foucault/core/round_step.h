#pragma once

#include <cmath>

namespace foucault {

/// The least of 1, 2, 5 times a power of ten that is not below `least`, but for rounding; least >
/// 0.
inline double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

}  // namespace foucault
