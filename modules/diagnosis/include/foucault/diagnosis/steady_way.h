#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {

/// A line through fixes at a steady horizontal velocity, by least squares: a way grows with time,
/// scatter does not, so it tells motion from errors whatever the sigmas promise.
class SteadyWay {
 public:
  /// Horizontal sigma [m], greater than zero.
  void add(const GnssFix& fix, double sigma);

  struct Velocity {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();  ///< north, east [m/s]
    /// Each axis [m/s], by what sigmas promise or by the scatter about the line: the larger.
    double sigma = 0;
  };
  /// None before three fixes.
  std::optional<Velocity> velocity() const;

 private:
  std::optional<geodesy::LocalFrame> frame_;  ///< at the first fix
  int64_t first_ns_ = 0;
  double count_ = 0, t_ = 0, tt_ = 0, xx_ = 0, variance_ = 0;  ///< sums
  Eigen::Vector2d x_ = Eigen::Vector2d::Zero(), tx_ = Eigen::Vector2d::Zero();
};

}  // namespace foucault::diagnosis
