#include "foucault/diagnosis/acceleration_match.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "level_drive.h"

namespace foucault::diagnosis {
namespace {

Eigen::Quaterniond about_down(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

TEST(AccelerationMatch, ForwardIsForwardBackwardOrSideways) {
  AccelerationMatch forward(about_down(0)), backward(about_down(kPi)), right(about_down(kPi / 2));
  surging().feed(forward);
  surging().feed(backward);
  surging().feed(right);
  EXPECT_GT(forward.correlation()->x(), 0.99);
  EXPECT_NEAR(forward.correlation()->y(), 0, 0.1);
  EXPECT_LT(backward.correlation()->x(), -0.99);
  EXPECT_GT(right.correlation()->y(), 0.99);
}

TEST(AccelerationMatch, TellsNothingFromFewOrSteadySpeeds) {
  AccelerationMatch few(about_down(0)), steady(about_down(0));
  LevelDrive drive = surging();
  drive.seconds = 50;
  drive.feed(few);
  EXPECT_FALSE(few.correlation());
  drive = LevelDrive();
  drive.seconds = 100;
  drive.feed(steady);
  EXPECT_FALSE(steady.correlation());
}

/// Fixes more often than once a second are passed over; rarer ones tell no change.
TEST(AccelerationMatch, ComparesFixesASecondApart) {
  AccelerationMatch often(about_down(0)), rare(about_down(0));
  LevelDrive drive = surging();
  drive.fix_interval = 0.1;
  drive.feed(often);
  EXPECT_GT(often.correlation()->x(), 0.99);
  drive.fix_interval = 3;
  drive.seconds = 400;
  drive.feed(rare);
  EXPECT_FALSE(rare.correlation());
}

}  // namespace
}  // namespace foucault::diagnosis
