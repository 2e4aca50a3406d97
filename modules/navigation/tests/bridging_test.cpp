#include "../src/bridging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_run.h"
#include "foucault/core/constants.h"

namespace foucault::navigation {
namespace {

using ::testing::SizeIs;
using namespace foucault::testing;  // NOLINT: measurements by milliseconds

/// North at 10 m/s until 0 ms, then no data for two seconds.
ImuHole hole() {
  ImuHole hole;
  hole.before.t_ns = at(0);
  hole.before.position = kPlace;
  hole.before.velocity_n = Vector3d(10, 0, 0);
  hole.gyro_before_b = Vector3d(0, 0, 0.2);
  hole.accel_before_b = Vector3d(1, 0, -9.8);
  hole.interval = 0.01;
  hole.after = increment_between(2000, 2010);
  hole.after.dtheta_b = Vector3d(0, 0, 0.1) * hole.after.dt();
  return hole;
}

Vector3d turned(const std::vector<ImuIncrement>& increments) {
  Vector3d sum = Vector3d::Zero();
  for (const ImuIncrement& increment : increments) sum += increment.dtheta_b;
  return sum;
}

TEST(Bridging, InterpolatesTheRatesOverTheWholeHole) {
  const std::vector<ImuIncrement> bridge = Bridging(hole()).bridge(GapOptions{});
  ASSERT_THAT(bridge, SizeIs(200));
  EXPECT_EQ(bridge.front().t_begin_ns, at(0));
  EXPECT_EQ(bridge.back().t_end_ns, at(2000));
  EXPECT_NEAR(turned(bridge).z(), 0.15 * 2, 1e-9);
  // A constant error of the rate over T is white noise of density sigma sqrt(T).
  EXPECT_NEAR(bridge[7].extra_gyro_noise_density, 6 * kDegree * std::sqrt(2), 1e-9);
}

TEST(Bridging, WaitsThreeSecondsForFixes) {
  Bridging bridging(hole());
  double t = 2010;
  bool over = false;
  for (; !over; t += 10) over = bridging.take(increment_between(t, t + 10));
  EXPECT_NEAR(t, 5010, 1);  // the first that ends after 5000
  EXPECT_FALSE(bridging.hole().turn);
  EXPECT_EQ(bridging.held().size(), static_cast<std::size_t>((t - 2000) / 10));
}

TEST(Bridging, EndsAtTheNextHole) {
  Bridging bridging(hole());
  EXPECT_FALSE(bridging.take(increment_between(2010, 2020)));
  EXPECT_TRUE(bridging.take(increment_between(2100, 2110)));
}

/// Fixes move east: a turn of 90 deg to the right, which the bridge makes.
TEST(Bridging, TheCourseAfterTheHoleTellsTheTurn) {
  ImuHole start = hole();
  start.after.dtheta_b.setZero();
  Bridging bridging(start);
  EXPECT_FALSE(bridging.take(fix_at(2005, Vector3d(20, 0, 0), 0.01)));
  double t = 2010;
  for (; t < 3000; t += 10) {
    ImuIncrement straight = increment_between(t, t + 10);
    straight.dtheta_b.setZero();
    ASSERT_FALSE(bridging.take(straight));
  }
  EXPECT_TRUE(bridging.take(fix_at(3005, Vector3d(20, 10, 0), 0.01)));
  ASSERT_TRUE(bridging.hole().turn);
  EXPECT_NEAR(bridging.hole().turn->angle, kPi / 2, 1e-3);
  EXPECT_NEAR(turned(bridging.bridge(GapOptions{})).z(), kPi / 2, 1e-3);
}

TEST(Bridging, ASlowVehicleTellsNoTurn) {
  ImuHole slow = hole();
  slow.before.velocity_n = Vector3d(1, 0, 0);
  Bridging bridging(slow);
  EXPECT_FALSE(bridging.take(fix_at(2005, Vector3d(20, 0, 0), 0.01)));
  EXPECT_FALSE(bridging.take(fix_at(3005, Vector3d(20, 10, 0), 0.01)));
}

}  // namespace
}  // namespace foucault::navigation
