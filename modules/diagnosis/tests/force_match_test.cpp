#include "foucault/diagnosis/force_match.h"

#include <gtest/gtest.h>

#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

/// Exact but for fixes of 1 cm: 1 s apart they tell the acceleration to 0.025 m/s^2.
TEST(ForceMatch, MeasuresTheFactorWhateverTheMotion) {
  for (const double factor : {1.0, 0.5, 1.3}) {
    for (LevelDrive drive : {LevelDrive(), surging(), winding()}) {
      drive.seconds = 120;
      drive.accel_factor = factor;
      ForceMatch match;
      drive.feed(match);
      ASSERT_TRUE(match.factor());
      EXPECT_NEAR(match.factor()->value, factor, 0.003 * factor);
      EXPECT_LT(match.factor()->sigma, 0.002);
      EXPECT_EQ(match.factor()->samples, match.windows());
    }
  }
}

TEST(ForceMatch, CoarseFixesNeedLongWindows) {
  LevelDrive drive = surging();
  drive.fix_sigma = 2;
  ForceMatch match;
  drive.feed(match);
  EXPECT_LE(match.windows(), 30);  // of 4 s and more
  ASSERT_TRUE(match.factor());
  EXPECT_NEAR(match.factor()->value, 1, 0.15);
}

/// Fixes between samples are met at their stamp.
TEST(ForceMatch, SplitsIncrementsAtFixes) {
  LevelDrive drive = surging();
  drive.imu_late = 0.003;
  ForceMatch match;
  drive.feed(match);
  ASSERT_TRUE(match.factor());
  EXPECT_NEAR(match.factor()->value, 1, 0.01);
}

TEST(ForceMatch, TellsNothingOfTightTurnsHolesOrBadFixes) {
  ForceMatch tight, holes, bad;
  six_g_turn().feed(tight);
  EXPECT_EQ(tight.windows(), 0);
  for (const Measurement& m : LevelDrive().measurements()) {
    const double t = seconds_between(LevelDrive::kStart, stamp(m));
    if (const auto* fix = std::get_if<GnssFix>(&m)) {
      holes.add(*fix);
      GnssFix none = *fix;
      none.position_covariance.setZero();
      bad.add(none);
    } else if (const auto* increment = std::get_if<ImuIncrement>(&m)) {
      bad.add(*increment);
      if (t - std::floor(t) > 0.5) holes.add(*increment);
    }
  }
  EXPECT_EQ(holes.windows(), 0);
  EXPECT_EQ(bad.windows(), 0);
  EXPECT_FALSE(bad.factor());
}

/// Fixes before the IMU, late ones and ones that are far ahead of it.
TEST(ForceMatch, PassesOverFixesElsewhen) {
  ForceMatch match;
  GnssFix fix;
  fix.position_covariance.setIdentity();
  match.add(fix);
  ImuIncrement increment;
  increment.t_end_ns = nanoseconds(0.01);
  match.add(increment);
  match.add(fix);
  fix.t_ns = nanoseconds(100);
  match.add(fix);
  EXPECT_EQ(match.windows(), 0);
}

/// The last thousand windows count.
TEST(ForceMatch, ForgetsWhatIsLongAgo) {
  LevelDrive drive;
  drive.seconds = 420;
  drive.fix_interval = 0.2;
  ForceMatch match;
  drive.feed(match);
  EXPECT_EQ(match.windows(), 1000);
  EXPECT_NEAR(match.factor()->value, 1, 0.01);
}

}  // namespace
}  // namespace foucault::diagnosis
