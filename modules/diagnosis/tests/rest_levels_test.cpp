#include "foucault/diagnosis/rest_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace foucault::diagnosis {
namespace {

ShakeLevel level_of(double force_sigma, double rate_sigma, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  ShakeMeter meter;
  for (int i = 0; i < 100; ++i) {
    ImuIncrement increment;
    increment.t_begin_ns = i * 10'000'000;
    increment.t_end_ns = increment.t_begin_ns + 10'000'000;
    const auto draw = [&] { return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)); };
    increment.dvel_b = 0.01 * (Eigen::Vector3d(0, 0, -9.8) + force_sigma * draw());
    increment.dtheta_b = 0.01 * rate_sigma * draw();
    meter.add(increment);
  }
  return *meter.level();
}

TEST(ShakeMeter, IsTheDeviationAboutTheMean) {
  std::mt19937 rng{1};
  const ShakeLevel level = level_of(0.02, 0.003, rng);
  EXPECT_NEAR(std::exp(level.force), 0.02 * std::sqrt(3), 0.004);
  EXPECT_NEAR(std::exp(level.rate), 0.003 * std::sqrt(3), 0.0006);
}

TEST(ShakeMeter, OfAFewSamplesHasNoLevel) {
  ShakeMeter meter;
  EXPECT_FALSE(meter.level());
  EXPECT_EQ(meter.mean_rate_sigma(), 0);
}

TEST(RestLevels, WithoutKnowledgeSayNothing) {
  EXPECT_NEAR(RestLevels().log_odds({-4, -6}), 0, 1e-12);
}

/// An idling engine at rest, a road in motion.
TEST(RestLevels, TellRestFromMotionByWhatTheyHaveSeen) {
  std::mt19937 rng{2};
  RestLevels levels;
  for (int i = 0; i < 20; ++i) levels.learn(level_of(0.2, 0.01, rng), true);
  for (int i = 0; i < 200; ++i) levels.learn(level_of(0.7, 0.03, rng), false);
  EXPECT_GT(levels.log_odds(level_of(0.2, 0.01, rng)), 4.6);
  EXPECT_LT(levels.log_odds(level_of(0.7, 0.03, rng)), -4.6);
}

/// Where a road shakes no more than a stop, the level decides nothing.
TEST(RestLevels, OfASmoothRideAreNoEvidence) {
  std::mt19937 rng{3};
  RestLevels levels;
  for (int i = 0; i < 50; ++i) levels.learn(level_of(0.2, 0.01, rng), i % 2 == 0);
  EXPECT_LT(std::abs(levels.log_odds(level_of(0.2, 0.01, rng))), 2);
}

/// Ten stretches in motion that were other are evidence of ten to one, no more.
TEST(RestLevels, EvidenceIsOfAsMuchAsWasSeen) {
  std::mt19937 rng{4};
  RestLevels levels;
  for (int i = 0; i < 500; ++i) levels.learn(level_of(0.2, 0.01, rng), true);
  const double none = levels.log_odds(level_of(0.2, 0.01, rng));
  for (int i = 0; i < 9; ++i) levels.learn(level_of(2, 0.2, rng), false);
  EXPECT_NEAR(levels.log_odds(level_of(0.2, 0.01, rng)) - none, std::log(10), 1);
}

}  // namespace
}  // namespace foucault::diagnosis
