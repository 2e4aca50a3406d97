#include "foucault/diagnosis/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

using ::testing::HasSubstr;

struct Verdict {
  std::string error;   ///< empty: the recording is good
  double after_s = 0;  ///< that it was refused
};

Verdict verdict_of(const std::vector<Measurement>& measurements) {
  Plausibility plausibility;
  Verdict verdict;
  try {
    for (const Measurement& m : measurements) {
      verdict.after_s = seconds_between(LevelDrive::kStart, stamp(m));
      if (const auto* fix = std::get_if<GnssFix>(&m)) plausibility.watch(*fix);
      if (const auto* increment = std::get_if<ImuIncrement>(&m)) {
        plausibility.watch(*increment);
        plausibility.throw_if_useless();
      }
    }
  } catch (const DataError& error) {
    verdict.error = error.what();
  }
  return verdict;
}

LevelDrive resting() {
  LevelDrive drive;
  drive.speed = [](double) { return 0.0; };
  drive.seconds = 120;
  return drive;
}

TEST(Plausibility, GoodRecordingsPass) {
  for (LevelDrive drive : {resting(), surging(), winding()}) {
    EXPECT_EQ(verdict_of(drive.measurements()).error, "");
    drive.gyro_factor = drive.accel_factor = 1.07;
    EXPECT_EQ(verdict_of(drive.measurements()).error, "");
  }
}

/// Steady turns and loops bear what they like; "a mean is gravity" is false.
TEST(Plausibility, ATurnOfSixGPasses) {
  LevelDrive drive = six_g_turn();
  drive.seconds = 120;
  EXPECT_EQ(verdict_of(drive.measurements()).error, "");
  // A body that rolls all the time has no mean direction.
  std::vector<Measurement> rolling = resting().measurements();
  for (Measurement& m : rolling) {
    auto* increment = std::get_if<ImuIncrement>(&m);
    if (!increment) continue;
    const double t = seconds_between(LevelDrive::kStart, increment->t_end_ns);
    increment->dvel_b = Eigen::AngleAxisd(-t, Eigen::Vector3d::UnitX()) * increment->dvel_b;
    increment->dtheta_b.x() += increment->dt();
  }
  EXPECT_EQ(verdict_of(rolling).error, "");
}

/// In motion mg and cm/s^2, which are 2 % apart, may be taken for each other.
TEST(Plausibility, UnitsOfTheForceAreToldEarlyAtRestAndInMotion) {
  const std::pair<double, const char*> units[] = {
      {1 / 9.80665, "in g,"}, {1000 / 9.80665, "in mg,"}, {100, "in cm/s^2,"}};
  for (const auto& [factor, name] : units) {
    for (LevelDrive drive : {resting(), surging(), winding()}) {
      for (const double sigma : {0.01, 1.5}) {
        drive.seconds = 20;
        drive.accel_factor = factor;
        drive.fix_sigma = sigma;
        const Verdict verdict = verdict_of(drive.measurements());
        EXPECT_THAT(verdict.error, HasSubstr("not m/s^2; name the unit in the import"));
        EXPECT_LT(verdict.after_s, 12);
        if (factor < 1) EXPECT_THAT(verdict.error, HasSubstr(name));
      }
    }
    LevelDrive drive = resting();
    drive.seconds = 20;
    drive.accel_factor = factor;
    EXPECT_THAT(verdict_of(drive.measurements()).error, HasSubstr(name));
  }
}

/// As Android's linear acceleration: without fixes by the mean over a minute, with them sooner.
TEST(Plausibility, GravityThatWasTakenOutIsMissed) {
  std::vector<Measurement> with = surging().measurements(), without;
  for (Measurement& m : with) {
    auto* increment = std::get_if<ImuIncrement>(&m);
    if (!increment) continue;
    increment->dvel_b.z() = 0;
    without.push_back(m);
  }
  const Verdict by_fixes = verdict_of(with), by_mean = verdict_of(without);
  EXPECT_THAT(by_fixes.error, HasSubstr("times what gravity and the motion of the fixes make it"));
  EXPECT_LT(by_fixes.after_s, 40);
  EXPECT_THAT(by_mean.error, HasSubstr("where gravity is 9.8"));
  EXPECT_NEAR(by_mean.after_s, 60, 0.1);
}

TEST(Plausibility, FactorsThatNoSensorHasEndARun) {
  LevelDrive accel = surging(), gyro = winding();
  accel.accel_factor = 0.5;
  gyro.speed = [](double) { return 4.0; };
  gyro.gyro_factor = 0.5;
  EXPECT_THAT(verdict_of(accel.measurements()).error, HasSubstr("specific force is 0."));
  EXPECT_THAT(verdict_of(gyro.measurements()).error, HasSubstr("the gyroscopes turn 0.5"));
}

TEST(Plausibility, ClocksAndAxesEndARun) {
  LevelDrive late = winding(), turned = winding();
  late.imu_late = 5;
  turned.gyro_factor = -1;
  EXPECT_THAT(verdict_of(late.measurements()).error, HasSubstr("s after those of GNSS"));
  EXPECT_THAT(verdict_of(turned.measurements()).error, HasSubstr("turn against the course"));
}

/// Rows up and down look alike when shifted by one, and the other way round.
TEST(Plausibility, RowsOfAFieldPass) {
  LevelDrive rows;
  rows.seconds = 400;
  rows.fix_interval = 0.5;
  rows.speed = [](double) { return 3.0; };
  // Half a turn to the right in 6 s every 22 s, then to the left, and so on.
  rows.heading = [](double t) {
    const double row = std::floor(t / 22);
    const double turned = std::clamp((t - 22 * row - 16) / 6, 0.0, 1.0);
    const bool is_right = std::fmod(row, 2) == 0;
    return kPi * (is_right ? turned : 1 - turned);
  };
  EXPECT_EQ(verdict_of(rows.measurements()).error, "");
}

}  // namespace
}  // namespace foucault::diagnosis
