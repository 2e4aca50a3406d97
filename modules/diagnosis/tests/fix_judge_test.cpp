#include "foucault/diagnosis/fix_judge.h"

#include <gtest/gtest.h>

#include <random>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;

GnssOptions gate(double false_alarm) {
  GnssOptions options;
  options.gate_false_alarm = false_alarm;
  return options;
}

state::Innovation innovation(double sigmas) {
  return {Vector3d(sigmas, 0, 0), Eigen::Matrix3d::Identity()};
}

/// Quantiles of the tables: 0.99 of chi-square of 1 to 3 degrees of freedom.
TEST(FixJudge, GatesByTheChiSquareTestOfTheDimension) {
  const double quantiles[] = {6.635, 9.210, 11.345};
  for (int dimension = 1; dimension <= 3; ++dimension) {
    const FixJudge judge(gate(0.01), dimension);
    EXPECT_TRUE(judge.passes(quantiles[dimension - 1] - 0.01)) << dimension;
    EXPECT_FALSE(judge.passes(quantiles[dimension - 1] + 0.01)) << dimension;
  }
}

/// The same of a measurement of up to six rows.
TEST(ChiSquareTail, IsThatOfTheTables) {
  const double quantiles[] = {6.635, 9.210, 11.345, 13.277, 15.086, 16.812};
  for (int dimension = 1; dimension <= 6; ++dimension)
    EXPECT_NEAR(chi_square_tail(quantiles[dimension - 1], dimension), 0.01, 3e-6) << dimension;
}

TEST(FixJudge, MahalanobisIsTheSquareBySigmas) {
  const Eigen::Matrix3d S = Vector3d(1, 4, 9).asDiagonal();
  EXPECT_DOUBLE_EQ(mahalanobis_squared(Vector3d(2, 2, 3), S), 6);
  EXPECT_DOUBLE_EQ(mahalanobis_squared(state::Innovation{Vector3d(2, 2, 3), S}), 6);
}

/// As many false alarms as promised, of innovations that are what they say: 20000 at one in a
/// hundred, within three sigmas.
TEST(FixJudge, FalseAlarmsAreAsManyAsPromised) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const FixJudge judge(gate(0.01));
  int gated = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d e(normal(rng), normal(rng), normal(rng));
    gated += !judge.passes(e.squaredNorm());
  }
  EXPECT_NEAR(gated, 200, 42);
}

/// Where sigmas are too small throughout, an outlier is what stands out of the others.
TEST(FixJudge, IsRelativeToTheMedianOfRecentOnes) {
  FixJudge judge(gate(1e-7));
  EXPECT_FALSE(judge.believes(0, innovation(10)));
  for (int i = 0; i < 20; ++i) judge.remember(100);
  EXPECT_NEAR(judge.level(), 100 / 2.366, 0.1);
  EXPECT_TRUE(judge.believes(0, innovation(10)));
  EXPECT_FALSE(judge.believes(0, innovation(100)));
  for (int i = 0; i < 31; ++i) judge.remember(1);
  EXPECT_LT(judge.level(), 2);  // what was before is forgotten
}

/// Sigmas that are too small in turns show in the mean of those that are believed.
TEST(FixJudge, TheMeanOfBelievedOnesRaisesTheLevel) {
  FixJudge judge(gate(1e-7));
  for (int i = 0; i < 600; ++i) judge.believes(0, innovation(i % 3 == 0 ? 5 : 0.5));
  EXPECT_GT(judge.level(), 2);
  judge.start(0);
  EXPECT_EQ(judge.level(), 1);
}

TEST(FixJudge, IsOpenAfterTheStateWasDoubted) {
  FixJudge judge(gate(1e-7));
  judge.doubt_state(nanoseconds(100));
  EXPECT_TRUE(judge.gate_is_open(nanoseconds(109)));
  EXPECT_TRUE(judge.believes(nanoseconds(109), innovation(50)));
  EXPECT_FALSE(judge.gate_is_open(nanoseconds(111)));
  EXPECT_TRUE(judge.state_is_doubted(nanoseconds(159)));
  EXPECT_FALSE(judge.state_is_doubted(nanoseconds(161)));
  EXPECT_FALSE(judge.is_off());
}

TEST(FixJudge, WithoutAGateAllAreBelieved) {
  FixJudge judge(gate(0));
  EXPECT_TRUE(judge.is_off());
  EXPECT_TRUE(judge.believes(0, innovation(1e3)));
}

}  // namespace
}  // namespace foucault::diagnosis
