#include "foucault/diagnosis/allan_watch.h"

#include <gtest/gtest.h>

#include <random>

namespace foucault::diagnosis {
namespace {

using Vector6d = AllanWatch::Vector6d;

/// Means over a second of white noise of this density have its value as their sigma.
TEST(AllanWatch, FindsTheDensityOfWhiteNoiseOverAnyTime) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal(0, 0.3);
  AllanWatch one(1), four(4);
  for (int s = 0; s < 4000; ++s) {
    const Vector6d mean = Vector6d::NullaryExpr([&] { return normal(rng); });
    one.add(mean);
    four.add(mean);
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(one.density()[i], 0.3, 0.03);  // 1000 differences: 2.5 sigmas
    EXPECT_NEAR(four.density()[i], 0.3, 0.03);
  }
}

/// Steps of a ramp: 0.2 a second over 2 s is a difference of 0.4.
TEST(AllanWatch, TakesTheMedianOfDifferencesOfNeighbours) {
  AllanWatch watch(2);
  for (int s = 0; s < 10; ++s) watch.add(Vector6d::Constant(0.2 * s));
  EXPECT_FALSE(watch.knows());
  EXPECT_NEAR(watch.density()[0], 0.4 / 0.6745, 1e-12);
  for (int s = 10; s < 12; ++s) watch.add(Vector6d::Constant(0.2 * s));
  EXPECT_TRUE(watch.knows());
}

TEST(AllanWatch, AnInterruptionIsNoDifference) {
  AllanWatch watch(1);
  watch.add(Vector6d::Zero());
  watch.interrupt();
  watch.add(Vector6d::Constant(1e6));
  EXPECT_EQ(watch.density()[0], 0);
}

}  // namespace
}  // namespace foucault::diagnosis
