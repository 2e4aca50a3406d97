#include "foucault/diagnosis/return_trial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "straight_navigator.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;
using ::testing::Each;
using ::testing::ElementsAre;

ReturnTrial::Verdict verdict_of(const std::vector<Vector3d>& errors_n) {
  ReturnTrial trial(StraightNavigator(rest(1, 0.02)), fix_at(0, errors_n[0]), 1);
  for (std::size_t i = 0; i < errors_n.size(); ++i) {
    const double t = static_cast<double>(i);
    EXPECT_FALSE(trial.is_over());
    if (i > 0) trial.propagate(increment_between(t - 1, t));
    trial.add(fix_at(t, errors_n[i]));
  }
  return trial.verdict();
}

TEST(FixLikelihood, AFixIsTrueOrAnOutlier) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(likelihood_of({Vector3d(2, 0, 0), I}).is_true);
  EXPECT_FALSE(likelihood_of({Vector3d(20, 0, 0), I}).is_true);
  EXPECT_NEAR(likelihood_of({Vector3d(2, 0, 0), I}).log_density, -2, 1e-12);
}

TEST(ReturnTrial, APredictionAsGoodAsItsCovariance) {
  const auto verdict = verdict_of(std::vector<Vector3d>(5, {1, 0, 0}));
  EXPECT_FALSE(verdict.offset);
  EXPECT_EQ(verdict.scale, 1);
  EXPECT_THAT(verdict.used, Each(true));
}

TEST(ReturnTrial, OnePredictionTooSureOfItself) {
  std::vector<Vector3d> errors;
  for (int t = 0; t < 5; ++t) errors.emplace_back(20 + t, 0, 0);
  const auto verdict = verdict_of(errors);
  EXPECT_FALSE(verdict.offset);
  EXPECT_GE(verdict.scale, 8);
  EXPECT_LE(verdict.scale, 128);
}

TEST(ReturnTrial, FixesThatAreOffInPositionAlone) {
  // Two axes, so that chance is excluded.
  const auto verdict = verdict_of(std::vector<Vector3d>(5, {60, -40, 30}));
  EXPECT_TRUE(verdict.offset);
  EXPECT_TRUE(verdict.certainly);
}

TEST(ReturnTrial, AnOutlierIsNotUsed) {
  const auto verdict = verdict_of({{1, 0, 0}, {1, 0, 0}, {0, 50, 0}, {1, 0, 0}, {1, 0, 0}});
  EXPECT_THAT(verdict.used, ElementsAre(true, true, false, true, true));
}

/// If no scale believes most of the fixes the largest one counts.
TEST(ReturnTrial, FixesThatContradictEachOther) {
  const auto verdict =
      verdict_of({{9e5, 0, 0}, {0, 9e5, 0}, {0, 0, 9e5}, {-9e5, 0, 0}, {0, -9e5, 0}});
  EXPECT_EQ(verdict.scale, kLargestScale);
}

TEST(ReturnTrial, IsOverAfterFiveSecondsAndFiveFixes) {
  ReturnTrial trial(StraightNavigator(rest(1, 0.02)), fix_at(0, {0, 0, 0}), 1);
  for (const double t : {0.0, 1.0, 2.0, 3.0}) trial.add(fix_at(t, {0, 0, 0}));
  EXPECT_FALSE(trial.is_over());
  trial.add(fix_at(4, {0, 0, 0}));
  EXPECT_FALSE(trial.is_over());
  trial.add(fix_at(5, {0, 0, 0}));
  EXPECT_TRUE(trial.is_over());
}

}  // namespace
}  // namespace foucault::diagnosis
