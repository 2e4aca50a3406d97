#include "foucault/diagnosis/fix_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// So many metres north of a place.
GnssFix fix_at(double t, double north) {
  GnssFix fix;
  fix.t_ns = nanoseconds(t);
  fix.antenna = {0.8 + north / 6.378e6, 0.1, 100};
  fix.position_covariance.setIdentity();
  return fix;
}

class FixGuardTest : public ::testing::Test {
 protected:
  int used(const std::vector<GnssFix>& fixes) {
    int count = 0;
    for (const GnssFix& fix : fixes) count += guard_.look_at(fix).fix.has_value();
    return count;
  }
  FixGuard guard_;
};

TEST_F(FixGuardTest, AVehicleIsUsed) {
  for (int t = 0; t < 50; ++t) EXPECT_TRUE(guard_.look_at(fix_at(t, 10 * t)).fix);
  EXPECT_THAT(guard_.summary(), IsEmpty());
}

TEST_F(FixGuardTest, WhatIsNoPositionIsLeftOut) {
  GnssFix zero = fix_at(0, 0), none = fix_at(1, 0), arm = fix_at(2, 0);
  zero.antenna = {0, 0, 0};
  none.antenna.height = std::numeric_limits<double>::quiet_NaN();
  arm.p_b_a.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(used({zero, none, arm, fix_at(3, 0)}), 1);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("3 fixes are no positions")));
}

TEST_F(FixGuardTest, WhatNoVehicleReachesIsLeftOut) {
  EXPECT_EQ(used({fix_at(0, 0), fix_at(1, 10), fix_at(2, 5e5), fix_at(3, 30)}), 3);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("1 fixes lie where no vehicle gets to")));
}

/// A wrong first fix costs one good one.
TEST_F(FixGuardTest, MoreFixesInARowAreBelieved) {
  EXPECT_TRUE(guard_.look_at(fix_at(0, 5e5)).fix);
  EXPECT_FALSE(guard_.look_at(fix_at(1, 0)).fix);
  EXPECT_TRUE(guard_.look_at(fix_at(2, 0)).fix);
  EXPECT_TRUE(guard_.look_at(fix_at(3, 0)).fix);
}

/// Whatever was before, for another minute it is another place.
TEST_F(FixGuardTest, AnotherPlaceIsBelievedAfterAMinute) {
  for (int t = 0; t < 200; ++t) guard_.look_at(fix_at(t, 0));
  int left_out = 0;
  for (int t = 200; t < 300; ++t) left_out += !guard_.look_at(fix_at(t, 1e6)).fix;
  EXPECT_EQ(left_out, 61);
}

TEST_F(FixGuardTest, ABadVelocityIsTakenOff) {
  GnssFix fix = fix_at(0, 0);
  fix.velocity_n = Eigen::Vector3d(std::nan(""), 0, 0);
  FixGuard::Verdict verdict = guard_.look_at(fix);
  ASSERT_TRUE(verdict.fix);
  EXPECT_FALSE(verdict.fix->velocity_n);
  fix = fix_at(1, 0);
  fix.velocity_n = Eigen::Vector3d::Zero();
  EXPECT_TRUE(guard_.look_at(fix).fix->velocity_n);
  fix.velocity_covariance(1, 1) = -1;
  fix.t_ns += 1;
  EXPECT_FALSE(guard_.look_at(fix).fix->velocity_n);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("2 fixes have a velocity")));
}

/// Ten times a second, of a receiver that measures once a second.
TEST_F(FixGuardTest, HeldPositionsCountOnce) {
  std::vector<GnssFix> fixes;
  for (int k = 0; k < 400; ++k) fixes.push_back(fix_at(0.1 * k, k / 10 * 10.0));
  // The first ten runs go before it is known.
  EXPECT_EQ(used(fixes), 101 + 30 - 1);
  EXPECT_TRUE(guard_.look_at(fix_at(40, 390)).held);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("repeat the position before them")));
}

/// At rest equally often, which noise does not do.
TEST_F(FixGuardTest, HeldPositionsAtRest) {
  std::vector<GnssFix> fixes;
  for (int k = 0; k < 400; ++k) fixes.push_back(fix_at(0.1 * k, k / 5 % 7 * 0.01));
  EXPECT_LT(used(fixes), 150);
}

TEST_F(FixGuardTest, NoiseAtRestRepeatsAsItLikes) {
  std::vector<GnssFix> fixes;
  for (int k = 0; k < 400; ++k) fixes.push_back(fix_at(k, (k * k / 7) % 3 * 0.01));
  EXPECT_EQ(used(fixes), 400);
}

TEST_F(FixGuardTest, AFixThatComesTwiceIsAnotherMatter) {
  std::vector<GnssFix> fixes;
  for (int k = 0; k < 100; ++k) fixes.insert(fixes.end(), 2, fix_at(k, 10 * k));
  EXPECT_EQ(used(fixes), 200);
}

}  // namespace
}  // namespace foucault::diagnosis
