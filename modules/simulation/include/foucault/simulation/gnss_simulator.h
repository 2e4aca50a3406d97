#pragma once

#include "foucault/core/measurement.h"
#include "foucault/simulation/random.h"
#include "foucault/simulation/scenario.h"

namespace foucault::simulation {

/// GNSS fixes of an antenna on a lever arm: true antenna position (and velocity if asked for) plus
/// white noise; the covariance reported is that of the noise. Quality: as told, or float_rtk while
/// degraded.
class GnssSimulator {
 public:
  /// Reads the gnss_* fields, lever_arm_m, mounting_deg and seed.
  explicit GnssSimulator(const ScenarioOptions& options);

  /// The fix at t_ns, t [s] after the start.
  GnssFix measure(const Motion& motion, int64_t t_ns, double t);

 private:
  bool degraded(double t) const;

  ScenarioOptions options_;
  Eigen::Vector3d p_b_a_;
  Draws position_draws_, velocity_draws_;
};

}  // namespace foucault::simulation
