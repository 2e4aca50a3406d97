#pragma once

#include <vector>

namespace foucault::diagnosis {

/// Noise of values in a row, about zero and without what stands out.
struct LastingNoise {
  double variance = 0;
  /// Of the power of white noise of that variance: larger where it lasts.
  double factor = 1;
  double variance_sigma = 0;  ///< of the variance, as well as so many values tell it
};

/// Correlations are summed up in pairs until one is negative (Geyer, Statistical Science 7, 1992).
/// Precondition: there are values.
LastingNoise lasting_noise(const std::vector<double>& values);

}  // namespace foucault::diagnosis
