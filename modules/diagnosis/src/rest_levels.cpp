#include "foucault/diagnosis/rest_levels.h"

#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::diagnosis {
namespace {

constexpr int kLeastShakes = 8;
constexpr std::size_t kLevelsMemory = 600;  // stretches: ten minutes
/// Standard deviations of a hundred samples are known to 7 %, a factor of 0.07 in the logarithm.
constexpr double kLevelSmoothing = 0.1;
/// Levels lie anywhere over three decades before anything is known of them.
constexpr double kBroadLevels = 7;

double level_density(const std::deque<ShakeLevel>& learned, const ShakeLevel& level) {
  double sum = 1 / (kBroadLevels * kBroadLevels);
  for (const ShakeLevel& known : learned) {
    const double square = std::pow((known.force - level.force) / kLevelSmoothing, 2) +
                          std::pow((known.rate - level.rate) / kLevelSmoothing, 2);
    sum += std::exp(-0.5 * square) / (2 * kPi * kLevelSmoothing * kLevelSmoothing);
  }
  return sum / static_cast<double>(learned.size() + 1);
}

double log_level(double variance) { return 0.5 * std::log(std::max(variance, 1e-20)); }

}  // namespace

/// About the first sample, so that squares of gravity do not hide what shakes.
void ShakeMeter::add(const ImuIncrement& increment) {
  Eigen::Matrix<double, 6, 1> rates;
  rates << increment.dvel_b, increment.dtheta_b;
  rates /= increment.dt();
  if (samples_++ == 0) first_ = rates;
  rates -= first_;
  sum_ += rates;
  squares_ += rates.cwiseAbs2();
}

Eigen::Matrix<double, 6, 1> ShakeMeter::variance() const {
  return squares_ / samples_ - (sum_ / samples_).cwiseAbs2();
}

double ShakeMeter::mean_rate_sigma() const {
  return samples_ > 0 ? std::sqrt(variance().tail<3>().cwiseMax(0).mean() / samples_) : 0;
}

std::optional<ShakeLevel> ShakeMeter::level() const {
  if (samples_ < kLeastShakes) return std::nullopt;
  return ShakeLevel{log_level(variance().head<3>().sum()), log_level(variance().tail<3>().sum())};
}

void RestLevels::learn(const ShakeLevel& level, bool at_rest) {
  std::deque<ShakeLevel>& learned = at_rest ? rest_ : motion_;
  learned.push_back(level);
  if (learned.size() > kLevelsMemory) learned.pop_front();
}

double RestLevels::log_odds(const ShakeLevel& level) const {
  return std::log(level_density(rest_, level) / level_density(motion_, level));
}

}  // namespace foucault::diagnosis
