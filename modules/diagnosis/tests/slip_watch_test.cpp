#include "foucault/diagnosis/slip_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/so3.h"

namespace foucault::diagnosis {
namespace {

/// A vehicle on a plane that turns and rolls forward about a point, with noise of the state of
/// 1 cm/s; what it does beside that is up to the test.
class Drive {
 public:
  explicit Drive(int seed) : rng_(seed) {}

  double draw() { return normal_(rng_); }

  /// The velocity of the point on the vehicle's axes.
  void second(SlipWatch& watch, const Eigen::Vector3d& point_v, double turn_rate,
              const std::optional<double>& wheel = {}) {
    const Eigen::Vector3d rate_v(0.02 * draw(), 0.02 * draw(), turn_rate);
    const Eigen::Quaterniond q_v_told = so3::exp({0, pitch, heading});
    const Eigen::Vector3d rate_b = q_v_told.conjugate() * rate_v;
    const Eigen::Vector3d velocity_b = q_v_told.conjugate() * point_v - rate_b.cross(arm_b) +
                                       0.01 * Eigen::Vector3d(draw(), draw(), draw());
    measurement::BodyStretch stretch;
    stretch.turn.setIdentity();
    stretch.rate_b = rate_b;
    state::Epoch epoch;
    epoch.velocity_n = velocity_b;
    epoch.covariance = state::NodeMatrix::Zero();
    epoch.covariance.diagonal().segment<3>(state::block::velocity.offset).setConstant(1e-4);
    watch.add(stretch, epoch, wheel);
  }

  const double pitch = -0.11, heading = 0.08;
  const Eigen::Vector3d arm_b{-1.2, 0.3, 0.4};

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
};

double turn_at(int second) { return 0.3 * std::sin(0.2 * second); }

TEST(SlipWatch, FindsMountingAndPointOfACar) {
  SlipWatch watch(Eigen::Quaterniond::Identity());
  Drive drive(1);
  for (int t = 0; t < 300; ++t) {
    const double speed = 8 + 4 * std::sin(0.05 * t);
    drive.second(watch, {speed, 0.03 * drive.draw(), 0.05 * drive.draw()}, turn_at(t),
                 speed / 1.02 + 0.01 * drive.draw());
  }
  ASSERT_TRUE(watch.slip());
  const SlipFindings& found = *watch.slip();
  EXPECT_NEAR(found.mounting[0], drive.pitch, 0.002);
  EXPECT_NEAR(found.mounting[1], drive.heading, 0.002);
  EXPECT_NEAR(found.arm_b.x(), drive.arm_b.x(), 0.1);
  EXPECT_NEAR(found.deviation[0], 0.03, 0.012);
  EXPECT_NEAR(found.deviation[1], 0.05, 0.02);
  EXPECT_LT(found.white.maxCoeff(), 0.12);
  ASSERT_TRUE(watch.wheel());
  EXPECT_NEAR(watch.wheel()->scale, 0.02, 0.003);
  EXPECT_LT(watch.wheel()->white, 0.1);
}

/// Leeway that lasts: half a metre a second for half a minute is of as much power as white noise of
/// several metres a second.
TEST(SlipWatch, LeewayOfABoatIsLargeAndLasts) {
  SlipWatch watch(Eigen::Quaterniond::Identity());
  Drive drive(2);
  double leeway = 0;
  for (int t = 0; t < 300; ++t) {
    leeway += (-leeway / 30) + 0.5 * std::sqrt(2.0 / 30) * drive.draw();
    drive.second(watch, {5, leeway, 0.1 * drive.draw()}, turn_at(t));
  }
  ASSERT_TRUE(watch.slip());
  EXPECT_GT(watch.slip()->deviation[0], 0.2);
  EXPECT_GT(watch.slip()->white[0], 1);
}

TEST(SlipWatch, WhatHoversRollsNowhere) {
  SlipWatch watch(Eigen::Quaterniond::Identity());
  Drive drive(3);
  for (int t = 0; t < 300; ++t) {
    const double way = 0.1 * t;
    drive.second(watch, {4 * std::cos(way), 4 * std::sin(way), std::sin(0.3 * t)}, turn_at(t));
  }
  ASSERT_TRUE(watch.slip());
  EXPECT_GT(watch.slip()->white.minCoeff(), 0.5);
}

TEST(SlipWatch, SaysNothingOfAFewSecondsOrOfRest) {
  SlipWatch watch(Eigen::Quaterniond::Identity());
  Drive drive(4);
  for (int t = 0; t < 25; ++t) drive.second(watch, {8, 0, 0}, turn_at(t));
  for (int t = 0; t < 100; ++t) drive.second(watch, {0.2, 0, 0}, 0);
  EXPECT_FALSE(watch.slip());
  EXPECT_FALSE(watch.wheel());
}

}  // namespace
}  // namespace foucault::diagnosis
