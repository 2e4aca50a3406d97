#include "lasting_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "foucault/core/median.h"

namespace foucault::diagnosis {

LastingNoise lasting_noise(const std::vector<double>& values) {
  std::vector<double> magnitudes;
  for (const double value : values) magnitudes.push_back(std::abs(value));
  const double robust = median(magnitudes) / 0.6745;
  std::vector<double> cut;
  LastingNoise noise;
  for (const double value : values) {
    cut.push_back(std::clamp(value, -3 * robust, 3 * robust));
    noise.variance += cut.back() * cut.back();
  }
  const std::size_t n = cut.size();
  noise.variance /= static_cast<double>(n);
  const auto correlation = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = lag; i < n; ++i) sum += cut[i] * cut[i - lag];
    return noise.variance > 0 ? sum / static_cast<double>(n) / noise.variance : 0;
  };
  for (std::size_t lag = 1; lag + 1 < n / 3; lag += 2) {
    const double pair = correlation(lag) + correlation(lag + 1);
    if (pair <= 0) break;
    noise.factor += 2 * pair;
  }
  noise.variance_sigma = noise.variance * std::sqrt(2 * noise.factor / static_cast<double>(n));
  return noise;
}

}  // namespace foucault::diagnosis
