#include "foucault/diagnosis/turn_match.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

using ::testing::HasSubstr;

TurnMatch match_of(const LevelDrive& drive, double longest = 1, double step = 0.02) {
  TurnMatcher matcher(longest, step);
  drive.feed(matcher);
  const std::optional<TurnMatch> best = matcher.best();
  EXPECT_TRUE(best);
  return best.value_or(TurnMatch());
}

TEST(TurnMatch, GyroscopesAndCoursesTurnAlike) {
  const TurnMatch match = match_of(town());
  EXPECT_NEAR(match.offset_s, 0, 0.01);
  EXPECT_NEAR(match.slope, 1, 0.01);
  EXPECT_GT(match.correlation, 0.99);
  EXPECT_GT(match.samples, 150);
  EXPECT_GT(match.turned, 20);
  EXPECT_FALSE(gross_mismatch(match, LevelDrive::kStart));
}

TEST(TurnMatch, FindsOffsetsToAPartOfTheGrid) {
  for (const double late : {0.275, -0.11, -0.6}) {
    LevelDrive drive = town();
    drive.imu_late = late;
    const TurnMatch match = match_of(drive);
    EXPECT_NEAR(match.offset_s, late, 0.01);
  }
}

TEST(TurnMatch, FindsTheFactorInGentleTurns) {
  LevelDrive drive = winding();
  drive.speed = [](double) { return 4.0; };
  drive.gyro_factor = 1.3;
  const TurnMatch match = match_of(drive);
  ASSERT_TRUE(match.gyro_factor);
  EXPECT_NEAR(match.gyro_factor->value, 1.3, 0.04);
  EXPECT_THAT(gross_mismatch(match, 0).value_or(""), HasSubstr("no gyroscope's scale factor"));
}

/// Where it flies straight, gusts turn it twice as much as the course does.
TEST(TurnMatch, GustsThatTurnAnAircraftAreNoScaleFactor) {
  LevelDrive flight = winding();
  flight.crab = [](double t) { return 0.15 * std::sin(1.1 * t); };
  const TurnMatch match = match_of(flight);
  EXPECT_GT(match.correlation, 0.9);
  ASSERT_TRUE(match.gyro_factor);
  EXPECT_GT(match.gyro_factor->value, 1.2);
  EXPECT_FALSE(gross_mismatch(match, LevelDrive::kStart));
}

TEST(TurnMatch, NamesUnitsAxesAndClocks) {
  const auto wrong = [](double factor, double late) {
    LevelDrive drive = winding();
    drive.gyro_factor = factor;
    drive.imu_late = late;
    return gross_mismatch(match_of(drive, 25, 0.25), LevelDrive::kStart).value_or("");
  };
  EXPECT_THAT(wrong(180 / kPi, 0), HasSubstr("in deg/s, not rad/s"));
  EXPECT_THAT(wrong(kPi / 180, 0), HasSubstr("converted to radians twice"));
  EXPECT_THAT(wrong(1, 5), HasSubstr("5.00 s after those of GNSS; correct"));
  EXPECT_THAT(wrong(1, -18), HasSubstr("before those of GNSS, as GPS time (18 s ahead) is of UTC"));
  EXPECT_EQ(wrong(1, 0), "");
}

TEST(TurnMatch, StraightSlowRareAndHoleyWaysTellNothing) {
  LevelDrive straight, slow = winding(), rare = winding();
  slow.speed = [](double) { return 0.3; };
  rare.fix_interval = 5;
  for (const LevelDrive& drive : {straight, slow, rare}) {
    TurnMatcher matcher(1, 0.02);
    drive.feed(matcher);
    EXPECT_FALSE(matcher.best());
  }
  TurnMatcher matcher(1, 0.02);
  for (const Measurement& m : winding().measurements()) {
    const double t = seconds_between(LevelDrive::kStart, stamp(m));
    if (const auto* fix = std::get_if<GnssFix>(&m)) matcher.add(*fix);
    const auto* increment = std::get_if<ImuIncrement>(&m);
    if (increment && t - std::floor(t) > 0.5) matcher.add(*increment);
  }
  EXPECT_EQ(matcher.samples(), 0);
}

/// A course that turns by more than a vehicle can is an outlier's.
TEST(TurnMatch, OutliersAreLeftOut) {
  TurnMatcher matcher(1, 0.02), clean(1, 0.02);
  winding().feed(clean);
  int fixes = 0;
  for (const Measurement& m : winding().measurements()) {
    if (const auto* increment = std::get_if<ImuIncrement>(&m)) matcher.add(*increment);
    if (const auto* fix = std::get_if<GnssFix>(&m)) {
      GnssFix bad = *fix;
      if (++fixes % 20 == 0) bad.antenna.longitude += 1e-5;  // 49 m
      if (fixes % 31 == 0) bad.position_covariance(0, 0) = std::nan("");
      matcher.add(bad);
    }
  }
  EXPECT_LT(matcher.samples(), clean.samples());
  EXPECT_GT(matcher.best()->correlation, 0.9);
}

/// The swing of an antenna is not a clock's, whether the lever arm is known or not; nor does it
/// hide one.
TEST(TurnMatch, ALeverArmIsNoOffset) {
  for (const double late : {0.0, 0.08}) {
    LevelDrive known = town(), unknown = town();
    known.imu_late = unknown.imu_late = late;
    known.arm = {2, -0.5, -1};
    unknown.untold_arm = 1.5;
    for (const LevelDrive& drive : {known, unknown}) {
      const TurnMatch match = match_of(drive);
      EXPECT_NEAR(match.offset_s, late, 0.01);
      EXPECT_NEAR(match.arm_m.value, drive.untold_arm, 0.1);
      EXPECT_LT(match.offset_sigma_s, 0.02);
    }
  }
}

/// Where the speed is always the same, an arm and an offset are.
TEST(TurnMatch, ASteadySpeedTellsNoOffset) {
  LevelDrive drive = winding();
  drive.untold_arm = 2;
  const TurnMatch match = match_of(drive);
  EXPECT_LT(std::abs(match.offset_s), 3 * match.offset_sigma_s);
}

TEST(TurnMatch, AClockThatRunsFast) {
  LevelDrive drive = town();
  drive.seconds = 600;
  drive.clock_fast = 200e-6;
  const TurnMatch match = match_of(drive);
  ASSERT_TRUE(match.drift);
  EXPECT_NEAR(match.drift->value, 200e-6, 30e-6);
  EXPECT_LT(match.drift->sigma, 50e-6);
}

/// Those of a walker, too.
TEST(TurnMatch, SlowVehiclesTurnAlike) {
  LevelDrive walk = winding();
  walk.speed = [](double) { return 1.4; };
  EXPECT_GT(match_of(walk).correlation, 0.95);
}

TEST(TurnMatch, NoisyFixesDoNotHideThatTurnsAgree) {
  LevelDrive drive = winding();
  drive.fix_sigma = 0.7;
  drive.fix_interval = 0.1;
  const TurnMatch match = match_of(drive);
  EXPECT_GT(match.correlation, 0.9);
  EXPECT_LT(match.misfit, 2);
}

TEST(TurnMatch, WhatDoesNotCorrelateIsNotJudged) {
  TurnMatch match;
  match.correlation = 0.5;
  match.slope = 57.3;
  EXPECT_FALSE(gross_mismatch(match, 0));
  EXPECT_FALSE(gross_mismatch(match, 0));
}

}  // namespace
}  // namespace foucault::diagnosis
