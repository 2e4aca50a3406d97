#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/core/measurement.h"
#include "foucault/simulation/trajectory.h"

namespace foucault::simulation {

/// A simulated trip and its sensors (all but the IMU's noise, which is an ImuNoise).
/// Units in the keys; "after start" counts from gps_week and gps_sow_s.
class ScenarioOptions : public Configurable {
 public:
  std::string name = "city";  ///< see scenario_names()
  double duration_s = 1617;
  int64_t seed = 1;

  double latitude_deg = 30.45, longitude_deg = 114.47, height_m = 20;
  std::optional<double> heading_deg;  ///< at the start; drawn from the seed if absent
  double rest_s = 40;                 ///< standing still before the trip
  double skip_s = 0;                  ///< of rest and trip, before the recording begins
  int64_t gps_week = 2200;
  double gps_sow_s = 357000;

  double imu_rate_hz = 200;
  Eigen::Vector3d mounting_deg = Eigen::Vector3d::Zero();  ///< roll, pitch, heading of b in v
  double scale_factor_sigma_ppm = 0;
  double vibration_hz = 25, vibration_m_s2 = 0, vibration_deg = 0;  ///< amplitudes; 0: none
  std::vector<double> imu_gap_start_s;                              ///< after start
  double imu_gap_length_s = 3;

  double gnss_rate_hz = 1;
  double gnss_phase_s = 0;                         ///< of the first fix after start
  Eigen::Vector3d gnss_sigma_m{0.01, 0.01, 0.02};  ///< north, east, down
  double gnss_velocity_sigma_m_s = 0;              ///< 0: no velocity in the fixes
  std::string gnss_quality = "fixed_rtk";          ///< fix_quality.h; while degraded: float_rtk
  bool gnss_noise = true;  ///< false: exact positions, sigmas reported all the same
  double gnss_degraded_start_s = 0, gnss_degraded_length_s = 0;  ///< after start
  double gnss_degraded_factor = 10;                              ///< on every sigma
  Eigen::Vector3d lever_arm_m{0.1, -0.3, -0.8};  ///< IMU to antenna, forward, right, down

  double reference_rate_hz = 10;  ///< 0: no reference poses

  void fields(ConfigFields& f) override;

  Geodetic start_position() const;
  int64_t start_ns() const;
  Eigen::Quaterniond q_v_b() const;
};

/// Names of the scenarios, the default first.
std::vector<std::string> scenario_names();

/// The true motion of a scenario, duration_s long or a little longer:
/// `city` 0-16 m/s with stops, right-angle turns and hills; `motorway` 30 m/s; `airliner` take-off,
/// climb, 250 m/s at 10 km with banked turns, descent, landing; `static`;
/// `walk` 1.2-1.6 m/s, swaying with its steps; `robot` 0.5-2.6 m/s, turns tightly or on the spot,
/// stops; `rows` a tractor, up and down at 2-3 m/s; `boat` 3-8 m/s in waves, with leeway up to
/// 20 deg; `copter` 0-10 m/s anywhere relative to its nose; `fixed_wing` 15-25 m/s in a wind, crab
/// angle up to 15 deg; `train` 10-40 m/s, wide curves; `reversing` a car, first backward.
/// The same options give the same motion. Throws UsageError for an unknown name.
Trajectory make_trajectory(const ScenarioOptions& options);

}  // namespace foucault::simulation
