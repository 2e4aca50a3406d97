#pragma once

#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/simulation/random.h"
#include "foucault/simulation/scenario.h"

namespace foucault::simulation {

/// GNSS fixes of an antenna on a lever arm: true antenna position (and velocity if asked for) plus
/// noise; the covariance reported is gnss_sigma_m's. Position noise, in units of gnss_sigma_m of
/// each axis: gnss_white_sigma of white and gnss_coloured_sigma of first-order Gauss-Markov noise.
/// The lever arm in a fix is the one that is told, the antenna sits lever_arm_error_m beside it.
/// Quality: as told, or float_rtk while degraded.
class GnssSimulator {
 public:
  /// Reads the gnss_* and heading_* fields, lever_arm_m, mounting_deg and seed.
  explicit GnssSimulator(const ScenarioOptions& options);

  /// The fix stamped t_ns, t [s] after the start, no earlier than the last one.
  GnssFix measure(const Motion& motion, int64_t t_ns, double t);

 private:
  bool degraded(double t) const;
  /// In units of the sigmas, by axes.
  Eigen::Vector3d position_noise(double t);

  GnssHeading heading(const Motion& motion);

  ScenarioOptions options_;
  Eigen::Vector3d p_b_a_;  ///< told
  Eigen::Vector3d p_v_a_;  ///< true
  Draws position_draws_, velocity_draws_, coloured_draws_, heading_draws_;
  Eigen::Vector3d coloured_;           ///< sigma 1
  std::optional<double> coloured_at_;  ///< [s]
};

}  // namespace foucault::simulation
