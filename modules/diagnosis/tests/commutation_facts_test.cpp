#include "foucault/diagnosis/commutation_facts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

/// The rate turns about z at `hz`, as on a cone: (a cos, a sin, 0), in increments at 100 Hz.
CommutationFacts cone(double rate, double hz, double noise_density = 0) {
  constexpr double kStep = 0.01;
  const double w = 2 * kPi * hz;
  std::mt19937 rng{3};
  std::normal_distribution<double> normal(0, noise_density * std::sqrt(kStep));
  CommutationWatch watch;
  for (int k = 0; k < 20000; ++k) {
    const double t0 = kStep * k, t1 = t0 + kStep;
    ImuIncrement increment;
    increment.t_begin_ns = nanoseconds(t0);
    increment.t_end_ns = nanoseconds(t1);
    increment.dtheta_b = {rate / w * (std::sin(w * t1) - std::sin(w * t0)) + normal(rng),
                          rate / w * (std::cos(w * t0) - std::cos(w * t1)) + normal(rng), 0};
    watch.add(increment);
  }
  return watch.facts();
}

/// Of an interval, with x = w dt and in units of (rate / w)^2: rotation vectors have (x - sin x) /
/// 2 by coning, the algorithm takes a twelfth of the product of neighbours for it.
double left_out(double rate, double hz) {
  const double w = 2 * kPi * hz, x = w * 0.01;
  const double exact = (x - std::sin(x)) / 2;
  const double taken = std::pow(std::sin(x / 2), 2) * std::sin(x) / 3;
  return std::pow(rate / w, 2) * (exact - taken) / 0.01;
}

TEST(CommutationWatch, IsRightWhereTheRateIsHigh) {
  EXPECT_NEAR(cone(0.5, 5).drift / left_out(0.5, 5), 1, 0.1);
  EXPECT_NEAR(cone(0.5, 10).drift / left_out(0.5, 10), 1, 0.2);
  EXPECT_NEAR(cone(0.5, 10).seconds, 200, 1);
}

/// And tells too little, not too much, where it is low.
TEST(CommutationWatch, IsALowerBoundWhereTheRateIsLow) {
  for (const double hz : {15.0, 20.0, 30.0}) {
    const double share = cone(0.5, hz).drift / left_out(0.5, hz);
    EXPECT_GT(share, 0.15) << hz;
    EXPECT_LT(share, 1) << hz;
  }
}

TEST(CommutationWatch, NoiseAndTurnsAboutOneAxisCommute) {
  constexpr double kDensity = 1e-3;  // [rad/s/sqrt(Hz)], 3.4 deg/sqrt(h)
  const CommutationFacts noise = cone(0, 10, kDensity);
  EXPECT_LT(noise.drift, 1e-6);
  EXPECT_LT(noise.random, 0.01 * kDensity);
  CommutationWatch watch;
  for (int k = 0; k < 1000; ++k) {
    ImuIncrement increment;
    increment.t_begin_ns = nanoseconds(0.1 * k);
    increment.t_end_ns = nanoseconds(0.1 * (k + 1));
    increment.dtheta_b = {0, 0, 0.1 * std::sin(0.3 * k)};
    watch.add(increment);
  }
  EXPECT_LT(watch.facts().drift, 1e-12);
}

TEST(CommutationWatch, AHoleBeginsAnew) {
  CommutationWatch watch;
  for (int k = 0; k < 100; ++k) {  // one second of each two
    ImuIncrement increment;
    increment.t_begin_ns = nanoseconds(0.1 * k + (k / 10));
    increment.t_end_ns = nanoseconds(0.1 * (k + 1) + (k / 10));
    watch.add(increment);
  }
  EXPECT_NEAR(watch.facts().seconds, 10, 1e-6);
  EXPECT_EQ(CommutationWatch().facts().seconds, 0);
}

}  // namespace
}  // namespace foucault::diagnosis
