#include "foucault/diagnosis/acceleration_match.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

std::optional<AccelerationFit> fit_of(const LevelDrive& drive, double mounting = 0) {
  AccelerationMatch match(
      Eigen::Quaterniond(Eigen::AngleAxisd(mounting, Eigen::Vector3d::UnitZ())));
  drive.feed(match);
  return match.best();
}

TEST(AccelerationMatch, ForwardIsForwardBackwardOrSideways) {
  for (const LevelDrive& drive : {surging(), town()}) {
    for (const double turned : {0.0, kPi / 2, kPi}) {
      const std::optional<AccelerationFit> fit = fit_of(drive, turned);
      ASSERT_TRUE(fit);
      EXPECT_GT(fit->correlation, 0.9);
      EXPECT_NEAR(std::cos(fit->angle.value - turned), 1, 0.01);
    }
  }
}

/// A walker's axes show as well as a car's.
TEST(AccelerationMatch, SlowVehiclesTellToo) {
  LevelDrive walk = winding();
  walk.speed = [](double t) { return 1.4 + 0.3 * std::sin(0.8 * t); };
  const std::optional<AccelerationFit> fit = fit_of(walk, kPi);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(std::abs(fit->angle.value), kPi, 0.2);
}

TEST(AccelerationMatch, FindsOffsetsWhateverTheLeverArm) {
  for (const double late : {0.0, 0.08, -0.3}) {
    LevelDrive drive = town();
    drive.imu_late = late;
    drive.arm = {1.5, 0.3, 0};
    const std::optional<AccelerationFit> fit = fit_of(drive);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->offset_s.value, late, 0.02);
    EXPECT_LT(fit->offset_s.sigma, 0.02);
  }
}

TEST(AccelerationMatch, SidesAreToldByTurnsOnly) {
  EXPECT_FALSE(fit_of(town())->mirrored);
  EXPECT_TRUE(fit_of(town())->is_side_known);
  EXPECT_FALSE(fit_of(surging())->is_side_known);
  LevelDrive swapped = town();
  swapped.is_track_mirrored = true;
  EXPECT_TRUE(fit_of(swapped)->mirrored);
  EXPECT_TRUE(fit_of(swapped)->is_side_known);
}

TEST(AccelerationMatch, TellsNothingFromFewOrSteadySpeeds) {
  LevelDrive few = surging(), steady, rare = surging();
  few.seconds = 12;
  steady.seconds = 100;
  rare.fix_interval = 3;
  for (const LevelDrive& drive : {few, steady, rare}) EXPECT_FALSE(fit_of(drive));
}

}  // namespace
}  // namespace foucault::diagnosis
