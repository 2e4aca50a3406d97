#include "../src/motion_fit.h"

#include <gtest/gtest.h>

#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {
namespace {

using Eigen::Vector3d;

const Vector3d kVelocity(3, -4, 0.2), kAcceleration(0.5, 0.3, -0.1);

/// p = v t + a t^2 / 2, with errors.
std::vector<GnssFix> fixes(double sigma, double duration, double interval, unsigned seed,
                           const Vector3d& v = kVelocity, const Vector3d& a = kAcceleration) {
  const geodesy::LocalFrame frame(Geodetic{48 * kDegree, 9 * kDegree, 300});
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal(0, sigma);
  std::vector<GnssFix> result;
  for (double t = 0; t < duration + 1e-9; t += interval) {
    const Vector3d p = v * t + 0.5 * a * t * t + Vector3d(normal(rng), normal(rng), normal(rng));
    GnssFix fix;
    fix.t_ns = nanoseconds(t);
    fix.antenna = frame.to_geodetic(p);
    fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    result.push_back(fix);
  }
  return result;
}

TEST(MotionFit, ErrorsAreWithinTheirSigmas) {
  double squares = 0;
  constexpr int kRuns = 100;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const MotionFit fit = fit_motion(fixes(0.5, 8, 0.5, seed));
    for (int axis = 0; axis < 3; ++axis) {
      const double v = (fit.begin_velocity_n - kVelocity)[axis],
                   a = (fit.acceleration_n - kAcceleration)[axis];
      squares += v * v / fit.covariance(axis, axis) / (6 * kRuns);
      squares += a * a / fit.covariance(axis + 3, axis + 3) / (6 * kRuns);
      EXPECT_LT(std::abs(v), 4 * std::sqrt(fit.covariance(axis, axis)));
    }
  }
  // The jerk that vehicles have is not simulated.
  EXPECT_GT(squares, 0.2);
  EXPECT_LT(squares, 1.2);
}

TEST(MotionFit, MeasuredVelocitiesServeWherePositionsAreCoarse) {
  std::vector<GnssFix> coarse = fixes(3, 4, 1, 7);
  const double without = fit_motion(coarse).covariance(0, 0);
  for (GnssFix& fix : coarse) {
    EXPECT_FALSE(velocity_is_better(fix));
    fix.velocity_n = kVelocity;
    fix.velocity_covariance = 0.01 * Eigen::Matrix3d::Identity();
    EXPECT_TRUE(velocity_is_better(fix));
  }
  EXPECT_LT(fit_motion(coarse).covariance(0, 0), 0.1 * without);
}

TEST(FitLine, TellsStandingFromCreeping) {
  int significant = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const MotionLine still = fit_line(fixes(0.5, 30, 1, seed, Vector3d::Zero(), Vector3d::Zero()));
    significant += still.velocity_n.norm() > 3.5 * still.sigma ? 1 : 0;
  }
  EXPECT_LE(significant, 2);
  const MotionLine creeping = fit_line(fixes(0.5, 30, 1, 3, Vector3d(0.3, 0, 0), Vector3d::Zero()));
  EXPECT_GT(creeping.velocity_n.norm(), 10 * creeping.sigma);
}

}  // namespace
}  // namespace foucault::alignment
