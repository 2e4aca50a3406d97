#include "foucault/simulation/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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
  ScenarioOptions copy;
  load_config_text(dump_config(options), "copy", copy);
  EXPECT_EQ(dump_config(copy), dump_config(options));
  EXPECT_EQ(copy.name, "airliner");
  EXPECT_EQ(copy.imu_gap_start_s, options.imu_gap_start_s);
  EXPECT_EQ(copy.gnss_noise, false);
}

}  // namespace
}  // namespace foucault::simulation
