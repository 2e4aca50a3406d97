#pragma once

#include <string>

#include "foucault/core/config.h"

namespace foucault::fgo {

/// Section `fgo` of the configuration.
class FgoOptions : public Configurable {
 public:
  double window_s = 20;         ///< length of the sliding window [s]
  double node_interval_s = 1;   ///< longest time between nodes without GNSS [s]
  std::string robust = "none";  ///< loss on GNSS residuals: none | huber | cauchy
  double robust_scale = 2;      ///< where the loss turns, in sigmas
  int64_t max_iterations = 8;   ///< of the solver, an epoch

  void fields(ConfigFields& f) override;
};

/// Radius of the first damped step, and how many times the options' iterations they may take. Where
/// attitudes are off by degrees while velocity increments are known to 1e-4 m/s, the valley of the
/// cost is curved, a plain step climbs out of it, and the radius must come down to the valley's.
inline constexpr double kDampedRadius = 1e4;
inline constexpr int kDampedIterations = 10;

}  // namespace foucault::fgo
