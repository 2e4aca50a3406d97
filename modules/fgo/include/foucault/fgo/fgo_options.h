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

}  // namespace foucault::fgo
