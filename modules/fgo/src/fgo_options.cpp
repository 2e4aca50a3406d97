#include "foucault/fgo/fgo_options.h"

namespace foucault::fgo {

void FgoOptions::fields(ConfigFields& f) {
  f.number("window_s", window_s, kNotNegative, "length of the sliding window");
  f.number("node_interval_s", node_interval_s, {0.01, 60},
           "longest time between nodes without GNSS");
  f.text("robust", robust, {"none", "huber", "cauchy"}, "loss on GNSS residuals");
  f.number("robust_scale", robust_scale, kPositive, "where the loss turns, in sigmas");
  f.integer("max_iterations", max_iterations, {1, 100}, "of the solver, an epoch");
}

}  // namespace foucault::fgo
