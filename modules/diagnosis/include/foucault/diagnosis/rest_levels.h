#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// How much the IMU shakes about its mean over a stretch: logarithms of the standard deviations of
/// specific force and rate, which engines, roads and hands change by factors.
struct ShakeLevel {
  double force = 0, rate = 0;
};

/// Collects a stretch.
class ShakeMeter {
 public:
  void add(const ImuIncrement& increment);
  /// None of fewer than eight samples.
  std::optional<ShakeLevel> level() const;
  /// Of the mean rate, if what shakes is white: each axis, their root mean square [rad/s].
  double mean_rate_sigma() const;

 private:
  Eigen::Matrix<double, 6, 1> variance() const;

  int samples_ = 0;
  Eigen::Matrix<double, 6, 1> sum_ = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> squares_ = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> first_ = Eigen::Matrix<double, 6, 1>::Zero();
};

/// What the levels of this recording are at rest and in motion, learned where fixes tell which of
/// the two it is.
class RestLevels {
 public:
  void learn(const ShakeLevel& level, bool at_rest);

  /// log p(level | rest) - log p(level | motion), the densities smoothed from what was learned
  /// (Parzen); zero of nothing. N stretches in motion none of which was like this one are evidence
  /// of N + 1 to one at most.
  double log_odds(const ShakeLevel& level) const;

 private:
  std::deque<ShakeLevel> rest_, motion_;
};

}  // namespace foucault::diagnosis
