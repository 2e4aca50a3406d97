#include "foucault/diagnosis/heading_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"

namespace foucault::diagnosis {
namespace {

constexpr double kHeadingNoise = 0.3 * kDegree;

/// Two minutes of headings that are off by so much, known to 2 deg.
HeadingWatch watched(double offset, double lasting = 0) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  HeadingWatch watch;
  double error = 0;
  for (int second = 0; second < 120; ++second) {
    error = lasting * error + std::sqrt(1 - lasting * lasting) * kHeadingNoise * normal(rng);
    watch.add(so3::wrap(offset + error), std::pow(2 * kDegree, 2));
  }
  return watch;
}

TEST(HeadingWatch, SaysNothingOfHalfAMinute) {
  HeadingWatch watch;
  for (int second = 0; second < 29; ++second) watch.add(0, 1e-4);
  EXPECT_FALSE(watch.found());
  watch.add(0, 1e-4);
  EXPECT_TRUE(watch.found());
}

/// 120 values know a deviation to 6.5 %; two sigmas of that and more are taken off.
TEST(HeadingWatch, NoiseIsAtLeastWhatIsBeyondDoubt) {
  const HeadingFindings found = *watched(0.5 * kDegree).found();
  EXPECT_NEAR(found.offset, 0.5 * kDegree, 0.1 * kDegree);  // 3 sigmas of the median
  EXPECT_NEAR(found.state_sigma, 2 * kDegree, 1e-9);
  EXPECT_LT(found.least_sigma, kHeadingNoise);
  EXPECT_GT(found.least_sigma, 0.6 * kHeadingNoise);
  EXPECT_FALSE(found.contradicts());
}

TEST(HeadingWatch, NoiseThatLastsCountsForMore) {
  const HeadingFindings white = *watched(0).found(), lasting = *watched(0, 0.8).found();
  EXPECT_GT(lasting.least_sigma, 1.5 * white.least_sigma);
}

/// Near half a turn differences have both signs.
TEST(HeadingWatch, SwappedAntennasContradict) {
  const HeadingFindings found = *watched(kPi).found();
  EXPECT_TRUE(found.contradicts());
  EXPECT_NEAR(std::abs(found.offset), kPi, 0.1 * kDegree);
  EXPECT_LT(found.least_sigma, kHeadingNoise);
  EXPECT_TRUE(watched(8 * kDegree).found()->contradicts());
  EXPECT_FALSE(watched(4 * kDegree).found()->contradicts());
}

}  // namespace
}  // namespace foucault::diagnosis
