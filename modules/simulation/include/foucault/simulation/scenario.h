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
/// Units in the keys; "after start" counts from gps_week and gps_sow_s. Errors are true minus told:
/// the truth is in the sensors, what is told in the recording. Each has its own random stream.
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
  Eigen::Vector3d mounting_error_deg = Eigen::Vector3d::Zero();
  double scale_factor_sigma_ppm = 0;
  double cross_axis_sigma_ppm = 0;                                  ///< see ImuFlaws
  double vibration_hz = 25, vibration_m_s2 = 0, vibration_deg = 0;  ///< amplitudes; 0: none
  double vibration_growth = 0;                                      ///< of both, by speed / 15 m/s
  double vibration_rectification_m_s2 = 0;                          ///< see ImuFlaws
  std::vector<double> imu_gap_start_s;                              ///< after start
  double imu_gap_length_s = 3;

  double gnss_rate_hz = 1;
  double gnss_phase_s = 0;                               ///< of the first fix after start
  Eigen::Vector3d gnss_sigma_m{0.01, 0.01, 0.02};        ///< north, east, down
  double gnss_white_sigma = 1, gnss_coloured_sigma = 0;  ///< of the noise, in units of gnss_sigma_m
  double gnss_coloured_tau_s = 100;
  double gnss_velocity_sigma_m_s = 0;      ///< 0: no velocity in the fixes
  std::string gnss_quality = "fixed_rtk";  ///< fix_quality.h; while degraded: float_rtk
  bool gnss_noise = true;                  ///< false: exact positions, sigmas reported all the same
  double gnss_degraded_start_s = 0, gnss_degraded_length_s = 0;  ///< after start
  double gnss_degraded_factor = 10;                              ///< on every sigma
  /// Fixes are of so much before their stamps: gnss_time_offset_s + gnss_time_drift_ppm 1e-6 t.
  double gnss_time_offset_s = 0, gnss_time_drift_ppm = 0;
  Eigen::Vector3d lever_arm_m{0.1, -0.3, -0.8};  ///< IMU to antenna, forward, right, down
  Eigen::Vector3d lever_arm_error_m = Eigen::Vector3d::Zero();

  double heading_sigma_deg = 0;           ///< of the heading of two antennas in the fixes; 0: none
  double heading_noise_factor = 1;        ///< true noise by that sigma
  double heading_baseline_error_deg = 0;  ///< true direction of the baseline, forward is told
  double heading_outlier_percent = 0;     ///< of any direction

  double wheel_rate_hz = 0;  ///< 0: no wheel speeds
  double wheel_scale_percent = 0, wheel_sigma_m_s = 0, wheel_step_m_s = 0;
  /// IMU to the point that follows the road and whose speed the wheels measure, forward, right,
  /// down (see make_trajectory).
  Eigen::Vector3d wheel_lever_arm_m = Eigen::Vector3d::Zero();
  double slip_sigma_m_s = 0, slip_tau_s = 30;  ///< Gauss-Markov, of that point to the right
  double slip_rad_per_m_s2 = 0;  ///< course less heading, of its acceleration to the right

  double reference_rate_hz = 10;  ///< 0: no reference poses

  void fields(ConfigFields& f) override;

  Geodetic start_position() const;
  int64_t start_ns() const;
  Eigen::Quaterniond q_v_b() const;       ///< as told
  Eigen::Quaterniond true_q_v_b() const;  ///< mounting_error_deg included

 private:
  void wheel_fields(ConfigFields& f);
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
/// The same options give the same motion.
///
/// The point that follows the road or path is the one at wheel_lever_arm_m, by default the IMU. On
/// city and motorway its course is the heading, but for slip_*: it does not slip sideways. The
/// splines turn its velocity by 0.125 s^2 times acceleration and yaw rate: without slip its lateral
/// velocity in v is 2 mm/s RMS and up to 4 cm/s where a city's car brakes into a turn, 2 mm/s at
/// most on the motorway. Its vertical velocity in v is not zero, 5 cm/s RMS and up to 0.2 m/s
/// (motorway 0.3): the body pitches on its springs by 0.35 deg per m/s^2 and bounces.
///
/// city stands at lights for 5 to 30 s, 6 to 17 times in 1617 s. But for the first and last second,
/// which the splines smooth, its velocity is then exactly zero, for 3 s at least; with a
/// wheel_lever_arm_m, the IMU's once the springs have settled.
///
/// Throws UsageError for an unknown name, and for slip_* of another than city and motorway.
Trajectory make_trajectory(const ScenarioOptions& options);

}  // namespace foucault::simulation
