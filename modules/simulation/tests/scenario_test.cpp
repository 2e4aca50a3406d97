#include "foucault/simulation/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::simulation {
namespace {

/// Extremes and means of a trip, every 0.1 s.
struct Summary {
  double max_speed = 0, mean_speed = 0, distance = 0;
  double max_lateral = 0;  ///< of the specific force, to the right in the horizontal plane
  double max_yaw_rate = 0, max_roll = 0, max_pitch = 0;
  double min_height = 1e9, max_height = -1e9;
  double standing = 0;  ///< [s]
  double max_side_slip = 0;
  double farthest = 0;  ///< from the start [m]
};

Summary summarize(const ScenarioOptions& options) {
  const Trajectory truth = make_trajectory(options);
  const geodesy::LocalFrame frame(options.start_position());
  const double dt = 0.1;
  Summary s;
  for (double t = 0; t < options.duration_s; t += dt) {
    const Motion motion = truth.at(t);
    const so3::Euler euler = so3::to_euler(motion.q_n_v);
    const Eigen::Quaterniond q_n_level = so3::from_euler({0, 0, euler.heading});
    const Eigen::Vector3d v_v = motion.q_n_v.conjugate() * motion.velocity_n;
    const double speed = motion.velocity_n.head<2>().norm();
    const Eigen::Vector3d f_level = q_n_level.conjugate() * (motion.q_n_v * motion.f_v);
    s.max_speed = std::max(s.max_speed, speed);
    s.distance += speed * dt;
    s.max_lateral = std::max(s.max_lateral, std::abs(f_level.y()));
    s.max_yaw_rate = std::max(s.max_yaw_rate, std::abs(motion.omega_iv_v.z()));
    s.max_roll = std::max(s.max_roll, std::abs(euler.roll));
    s.max_pitch = std::max(s.max_pitch, std::abs(euler.pitch));
    s.min_height = std::min(s.min_height, motion.position.height);
    s.max_height = std::max(s.max_height, motion.position.height);
    if (speed < 0.01) s.standing += dt;
    if (speed > 3) s.max_side_slip = std::max(s.max_side_slip, std::abs(v_v.y() / v_v.x()));
    s.farthest = std::max(s.farthest, frame.to_local(motion.position).norm());
  }
  s.mean_speed = s.distance / options.duration_s;
  return s;
}

TEST(Scenario, CityIsACarInACity) {
  for (int seed = 1; seed <= 5; ++seed) {
    ScenarioOptions options;
    options.seed = seed;
    const Summary s = summarize(options);
    EXPECT_LT(s.max_speed, 16.5);
    EXPECT_GT(s.mean_speed, 8.5);
    EXPECT_LT(s.mean_speed, 11.5);
    EXPECT_LT(s.max_lateral, 4.0);
    EXPECT_GT(s.max_yaw_rate, 25 * kDegree);
    EXPECT_LT(s.max_yaw_rate, 35 * kDegree);
    EXPECT_LT(s.max_roll, 2 * kDegree);
    EXPECT_LT(s.max_pitch, 3 * kDegree);
    EXPECT_GT(s.standing, options.rest_s + 30);
    EXPECT_LT(s.standing, 400);
    EXPECT_GT(s.min_height, options.height_m - 16);
    EXPECT_LT(s.max_height, options.height_m + 16);
    EXPECT_LT(s.max_side_slip, 0.6 * kDegree);
  }
}

/// Lateral velocity of the point at wheel_lever_arm_m, and what goes with it, where the car drives.
struct Sideways {
  std::vector<double> velocity;      ///< to the right in v [m/s]
  std::vector<double> imu_velocity;  ///< the same of the IMU
  std::vector<double> speed;         ///< [m/s]
  std::vector<double> lateral;       ///< acceleration to the right [m/s^2]
};

Sideways sideways(const ScenarioOptions& options, double dt) {
  const Trajectory truth = make_trajectory(options);
  Sideways s;
  for (double t = options.rest_s; t < options.duration_s; t += dt) {
    const Motion motion = truth.at(t);
    const Eigen::Vector3d v_v =
        motion.q_n_v.conjugate() * point_velocity_n(motion, options.wheel_lever_arm_m);
    if (v_v.x() < 4) continue;
    s.velocity.push_back(v_v.y());
    s.imu_velocity.push_back((motion.q_n_v.conjugate() * motion.velocity_n).y());
    s.speed.push_back(v_v.x());
    s.lateral.push_back(v_v.x() * motion.omega_iv_v.z());
  }
  return s;
}

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double farthest_from_zero(const std::vector<double>& values) {
  double farthest = 0;
  for (const double value : values) farthest = std::max(farthest, std::abs(value));
  return farthest;
}

// What is left is the splines': 0.125 s^2 times acceleration and yaw rate (scenario.h).
TEST(Scenario, PointAtTheWheelsDoesNotSlip) {
  for (const Eigen::Vector3d& arm :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-1.5, 0.3, 0.6), Eigen::Vector3d(2, 0, -1)}) {
    ScenarioOptions options;
    options.wheel_lever_arm_m = arm;
    const Sideways city = sideways(options, 0.1);
    EXPECT_LT(rms(city.velocity), 4e-3);
    EXPECT_LT(farthest_from_zero(city.velocity), 0.05);
    options.name = "motorway";
    EXPECT_LT(farthest_from_zero(sideways(options, 0.1).velocity), 0.004);
    // The IMU ahead of it or behind is moved sideways by a yaw rate of up to 0.5 rad/s.
    EXPECT_GT(farthest_from_zero(city.imu_velocity), 0.35 * std::abs(arm.x()));
  }
}

// Ten trips of 1400 s are 350 independent values of tau 20: 7.5 % of a variance.
TEST(Scenario, SlipIsGaussMarkovAndLeavesThePathAsItIs) {
  double square = 0, product = 0;
  std::size_t count = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    ScenarioOptions options;
    options.name = "motorway";  // does not stop: samples are evenly spaced
    options.seed = seed;
    const Motion straight = make_trajectory(options).at(1000);
    options.slip_sigma_m_s = 0.1;
    options.slip_tau_s = 20;
    EXPECT_EQ(make_trajectory(options).at(1000).p_e, straight.p_e);
    const std::vector<double> slip = sideways(options, 1).velocity;
    for (std::size_t i = 20; i < slip.size(); ++i) {
      square += slip[i] * slip[i];
      product += slip[i] * slip[i - 20];
      ++count;
    }
  }
  EXPECT_NEAR(square / static_cast<double>(count) / 0.01, 1, 0.25);
  EXPECT_NEAR(product / square, std::exp(-1), 0.15);
}

TEST(Scenario, SlipFollowsTheLateralAcceleration) {
  ScenarioOptions options;
  options.slip_rad_per_m_s2 = 0.004;
  const Sideways s = sideways(options, 0.1);
  std::vector<double> residual;
  for (std::size_t i = 0; i < s.velocity.size(); ++i) {
    residual.push_back(s.velocity[i] - 0.004 * s.lateral[i] * s.speed[i]);
  }
  EXPECT_GT(farthest_from_zero(s.velocity), 0.06);  // 3 m/s^2 at 6 m/s
  EXPECT_LT(rms(residual), 0.15 * rms(s.velocity));
}

TEST(Scenario, SlipIsRefusedWhereNothingFollowsIt) {
  ScenarioOptions options;
  options.name = "train";
  options.slip_sigma_m_s = 0.1;
  EXPECT_THROW(make_trajectory(options), UsageError);
}

/// Lengths of exact standstills after the rest, all within the recording [s].
std::vector<double> standstills(const ScenarioOptions& options) {
  const Trajectory truth = make_trajectory(options);
  std::vector<double> lengths;
  double standing = 0;
  for (double t = options.rest_s + 10; t < options.duration_s; t += 0.05) {
    if (truth.at(t).velocity_n.norm() == 0) {
      standing += 0.05;
    } else if (standing > 0) {
      lengths.push_back(standing);
      standing = 0;
    }
  }
  return lengths;
}

TEST(Scenario, CityStandsStillAtItsLights) {
  for (int seed = 1; seed <= 5; ++seed) {
    ScenarioOptions options;
    options.seed = seed;
    const std::vector<double> lengths = standstills(options);
    EXPECT_GE(lengths.size(), 4u) << seed;
    for (const double length : lengths) {
      EXPECT_GE(length, 2.9) << seed;  // 5 s less what the splines smooth
      EXPECT_LE(length, 30.1) << seed;
    }
  }
}

/// Largest vertical vibration within a second [m/s^2].
double vibration(const Trajectory& vibrating, const Trajectory& quiet, double from) {
  std::vector<double> extra;
  for (double t = from; t < from + 1; t += 0.0007) {
    extra.push_back((vibrating.at(t).f_v - quiet.at(t).f_v).z());
  }
  return farthest_from_zero(extra);
}

TEST(Scenario, VibratesWhereItStandsAndMoreWhereItDrives) {
  ScenarioOptions options;
  options.name = "motorway";
  options.duration_s = 120;
  const Trajectory quiet = make_trajectory(options);
  ASSERT_NEAR(quiet.at(100).velocity_n.norm(), 30, 3);
  options.vibration_m_s2 = 0.5;
  const Trajectory even = make_trajectory(options);
  options.vibration_growth = 3;
  const Trajectory growing = make_trajectory(options);
  EXPECT_NEAR(vibration(even, quiet, 20), 0.5, 0.01);
  EXPECT_NEAR(vibration(even, quiet, 100), 0.5, 0.01);
  EXPECT_NEAR(vibration(growing, quiet, 20), 0.5, 0.01);
  const double speed = quiet.at(100.5).velocity_n.norm();
  EXPECT_NEAR(vibration(growing, quiet, 100), 0.5 * (1 + 3 * speed / 15), 0.05);
}

TEST(Scenario, MotorwayGoesFarAndFast) {
  ScenarioOptions options;
  options.name = "motorway";
  options.duration_s = 2200;
  const Summary s = summarize(options);
  EXPECT_LT(s.max_speed, 33);
  EXPECT_GT(s.mean_speed, 28.5);
  EXPECT_GT(s.farthest, 60e3);
  EXPECT_LT(s.max_lateral, 1.5);
  EXPECT_NEAR(s.standing, options.rest_s, 2);
}

TEST(Scenario, AirlinerClimbsCruisesTurnsAndLands) {
  ScenarioOptions options;
  options.name = "airliner";
  options.duration_s = 3600;
  const Summary s = summarize(options);
  EXPECT_NEAR(s.max_speed, 250, 1);
  EXPECT_NEAR(s.max_height, options.height_m + 10000, 2);
  EXPECT_GT(s.max_roll, 15 * kDegree);
  EXPECT_LT(s.max_roll, 28 * kDegree);
  EXPECT_LT(s.max_pitch, 16 * kDegree);
  EXPECT_GT(s.farthest, 500e3);
  const Motion end = make_trajectory(options).at(3599);
  EXPECT_NEAR(end.position.height, options.height_m, 2);
  EXPECT_LT(end.velocity_n.norm(), 0.01);
}

TEST(Scenario, ShortFlightStillFlies) {
  ScenarioOptions options;
  options.name = "airliner";
  options.duration_s = 200;
  const Motion end = make_trajectory(options).at(199);
  EXPECT_GT(end.position.height, 800);
  EXPECT_GT(end.velocity_n.norm(), 100);
}

TEST(Scenario, StartsWhereAndHowItIsTold) {
  for (const std::string& name : scenario_names()) {
    ScenarioOptions options;
    options.name = name;
    options.duration_s = 100;
    options.latitude_deg = -75;
    options.longitude_deg = 179.9999;
    options.heading_deg = 77;
    const Motion start = make_trajectory(options).at(0);
    EXPECT_NEAR(start.position.latitude, -75 * kDegree, 1e-14);
    EXPECT_NEAR(start.position.longitude, 179.9999 * kDegree, 1e-13);
    EXPECT_NEAR(start.position.height, 20, 1e-8);
    EXPECT_NEAR(so3::to_euler(start.q_n_v).heading, 77 * kDegree, 1e-12);
  }
}

TEST(Scenario, SameSeedSameMotionOtherSeedOtherMotion) {
  for (const std::string& name : scenario_names()) {
    ScenarioOptions options;
    options.name = name;
    options.duration_s = 300;
    options.heading_deg = 20;
    const Trajectory a = make_trajectory(options), b = make_trajectory(options);
    options.seed = 2;
    const Trajectory c = make_trajectory(options);
    EXPECT_EQ(a.at(250).p_e, b.at(250).p_e) << name;
    if (name == "static") continue;
    EXPECT_GT((a.at(250).p_e - c.at(250).p_e).norm(), 1) << name;
  }
}

// 60 s are a multiple of every knot interval, so that the splines are the same.
TEST(Scenario, RecordingBeginsAnywhereInTheTrip) {
  for (const std::string& name : scenario_names()) {
    ScenarioOptions options;
    options.name = name;
    options.rest_s = 5;
    options.duration_s = 160;
    const Trajectory whole = make_trajectory(options);
    options.skip_s = 60;
    options.duration_s = 100;
    const Trajectory part = make_trajectory(options);
    for (double t : {0.0, 0.07, 30.0, 99.0}) {
      EXPECT_LT((part.at(t).p_e - whole.at(60 + t).p_e).norm(), 1e-8) << name << " at " << t;
      EXPECT_LT((part.at(t).velocity_n - whole.at(60 + t).velocity_n).norm(), 1e-7) << name;
    }
  }
}

TEST(Scenario, LongerTripBeginsAsTheShorterOne) {
  ScenarioOptions options;
  options.duration_s = 300;
  const Trajectory shorter = make_trajectory(options);
  options.duration_s = 600;
  EXPECT_EQ(make_trajectory(options).at(299).p_e, shorter.at(299).p_e);
}

TEST(Scenario, WorksWithoutRest) {
  ScenarioOptions options;
  options.rest_s = 0;
  options.duration_s = 60;
  EXPECT_GT(make_trajectory(options).at(20).velocity_n.norm(), 1);
}

TEST(Scenario, UnknownNameNamesTheKnownOnes) {
  ScenarioOptions options;
  options.name = "submarine";
  try {
    make_trajectory(options);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("submarine"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("city, motorway, airliner, static, walk"));
  }
}

TEST(ScenarioOptions, SurviveYaml) {
  ScenarioOptions options;
  options.name = "airliner";
  options.seed = 99;
  options.heading_deg = 12.5;
  options.mounting_deg = {1, 2, 3};
  options.imu_gap_start_s = {100, 200.5};
  options.gnss_sigma_m = {0.1, 0.2, 0.3};
  options.gnss_noise = false;
  options.gnss_phase_s = 0.3;
  options.skip_s = 12;
  options.gnss_quality = "single";
  options.mounting_error_deg = {0.5, 2, -3};
  options.cross_axis_sigma_ppm = 800;
  options.gnss_coloured_sigma = 1.5;
  options.gnss_time_offset_s = -0.05;
  options.wheel_lever_arm_m = {-1, 0, 1};
  options.slip_rad_per_m_s2 = 0.004;
  ScenarioOptions copy;
  load_config_text(dump_config(options), "copy", copy);
  EXPECT_EQ(dump_config(copy), dump_config(options));
  EXPECT_EQ(copy.name, "airliner");
  EXPECT_EQ(copy.imu_gap_start_s, options.imu_gap_start_s);
  EXPECT_EQ(copy.gnss_noise, false);
}

}  // namespace
}  // namespace foucault::simulation
