#pragma once

#include "foucault/core/measurement.h"
#include "foucault/simulation/random.h"
#include "foucault/simulation/scenario.h"

namespace foucault::simulation {

/// A wheel sensor: along v's forward axis, the velocity of the point wheel_lever_arm_m from the
/// IMU,
///   measured = (1 + wheel_scale_percent / 100) * true + noise, rounded to wheel_step_m_s.
/// Wheels that stand count nothing: below 1 mm/s the speed is exactly zero.
class WheelSimulator {
 public:
  /// Reads the wheel_* fields and seed.
  explicit WheelSimulator(const ScenarioOptions& options);

  WheelSpeed measure(const Motion& motion, int64_t t_ns);

 private:
  Eigen::Vector3d p_v_wheel_;  ///< IMU to the point [m]
  double scale_, sigma_, step_;
  Draws draws_;
};

}  // namespace foucault::simulation
