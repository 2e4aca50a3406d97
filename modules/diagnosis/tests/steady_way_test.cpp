#include "foucault/diagnosis/steady_way.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

/// Of fixes at 1 Hz from an origin, with white errors.
SteadyWay drive(int fixes, double north_m_s, double error, double sigma, unsigned seed) {
  const geodesy::LocalFrame frame({0.8, 0.2, 300});
  std::mt19937 rng{seed};
  std::normal_distribution<double> normal(0, error);
  SteadyWay way;
  for (int t = 0; t < fixes; ++t) {
    GnssFix fix;
    fix.t_ns = nanoseconds(t);
    fix.antenna = frame.to_geodetic({north_m_s * t + normal(rng), normal(rng), 0});
    way.add(fix, sigma);
  }
  return way;
}

TEST(SteadyWay, TwoFixesTellNothing) {
  EXPECT_FALSE(SteadyWay().velocity());
  EXPECT_FALSE(drive(2, 0, 1, 1, 1).velocity());
  EXPECT_TRUE(drive(3, 0, 1, 1, 1).velocity());
}

TEST(SteadyWay, VelocityOfALine) {
  const SteadyWay::Velocity velocity = drive(10, 3, 0, 0.1, 1).velocity().value();
  EXPECT_NEAR(velocity.mean.x(), 3, 1e-5);
  EXPECT_NEAR(velocity.mean.y(), 0, 1e-5);
  EXPECT_NEAR(velocity.sigma, 0.1 / std::sqrt(82.5), 1e-9);  // sum of (t - 4.5)^2
}

/// Sigmas that promise ten times too little. The mean of 200 values of an F distribution with 2 and
/// 20 degrees of freedom, to four of its sigmas.
TEST(SteadyWay, SigmaIsThatOfTheScatterIfItIsLarger) {
  double squares = 0;
  constexpr int kRuns = 200;
  for (unsigned run = 0; run < kRuns; ++run) {
    const SteadyWay::Velocity velocity = drive(12, 5, 1, 0.1, run).velocity().value();
    squares += (velocity.mean - Eigen::Vector2d(5, 0)).squaredNorm() /
               (2 * velocity.sigma * velocity.sigma);
  }
  EXPECT_NEAR(squares / kRuns, 20.0 / 18, 0.35);
}

}  // namespace
}  // namespace foucault::diagnosis
