#include "../src/moving_alignment.h"

#include <gtest/gtest.h>

#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {
namespace {

using Eigen::Vector3d;

const geodesy::LocalFrame kFrame(Geodetic{48 * kDegree, 9 * kDegree, 300});
const Vector3d kVelocity(10, -4, 0.2), kAcceleration(0.5, 0.8, -0.1);

std::deque<GnssFix> fixes_of(double sigma, unsigned seed, bool with_velocity) {
  std::mt19937 rng{seed};
  std::normal_distribution<double> normal;
  const auto noise = [&](double s) -> Vector3d {
    return s * Vector3d(normal(rng), normal(rng), normal(rng));
  };
  std::deque<GnssFix> fixes;
  for (int t = 0; t <= 6; ++t) {
    GnssFix fix;
    fix.t_ns = t * kNanosecondsPerSecond;
    const Vector3d p = t * kVelocity + 0.5 * t * t * kAcceleration;
    fix.antenna = kFrame.to_geodetic(p + noise(sigma));
    fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
    if (with_velocity) {
      fix.velocity_n = kVelocity + t * kAcceleration + noise(0.05);
      fix.velocity_covariance = 0.0025 * Eigen::Matrix3d::Identity();
    }
    fixes.push_back(fix);
  }
  return fixes;
}

MotionFit fit(const std::deque<GnssFix>& fixes) { return fit_motion(fixes.begin(), fixes.end()); }

/// The filter knows of a constant acceleration, so exact fixes give exact answers, but for priors
/// of 100 m/s and 3 m/s^2 against the fixes' millimetres.
TEST(FitMotion, IsExactOnAParabola) {
  std::deque<GnssFix> fixes = fixes_of(0, 1, false);
  for (GnssFix& fix : fixes) fix.position_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  const MotionFit motion = fit(fixes);
  EXPECT_EQ(motion.duration, 6);
  EXPECT_LT((motion.velocity_n - kVelocity - 6 * kAcceleration).norm(), 1e-3);
  EXPECT_LT((motion.begin_velocity_n - kVelocity).norm(), 0.02);  // NED turns, jerk is allowed for
  EXPECT_LT((motion.acceleration_n - kAcceleration).norm(), 5e-3);
}

TEST(FitMotion, CourseTurnsAsTheVelocityDoes) {
  const MotionFit motion = fit(fixes_of(0.01, 1, false));
  EXPECT_GT(motion.fastest_turn, 0.02);
  EXPECT_LT(motion.fastest_turn, 0.15);
}

/// The jerk that the filter allows for is not there: its errors are smaller than their covariance
/// says, by less than a factor of three.
TEST(FitMotion, ErrorsAreNotLargerThanTheirSigmas) {
  for (const bool with_velocity : {false, true}) {
    const double sigma = with_velocity ? 1 : 0.05;
    double squares = 0;
    constexpr int kRuns = 200;
    for (int run = 0; run < kRuns; ++run) {
      const MotionFit motion = fit(fixes_of(sigma, static_cast<unsigned>(run), with_velocity));
      Eigen::Matrix<double, 6, 1> error;
      error << kVelocity + 6 * kAcceleration - motion.velocity_n,
          kAcceleration - motion.acceleration_n;
      squares += error.dot(motion.covariance.ldlt().solve(error)) / 6;
    }
    EXPECT_LT(squares / kRuns, 1.1) << with_velocity;
    EXPECT_GT(squares / kRuns, 0.1) << with_velocity;
  }
}

TEST(FitMotion, AFixThatIsOffShowsInTheInnovations) {
  std::deque<GnssFix> fixes = fixes_of(0.01, 1, false);
  EXPECT_LT(fit(fixes).innovation_ratio, 4);
  fixes[4].antenna.height += 30;
  EXPECT_GT(fit(fixes).innovation_ratio, 9);
}

/// What coarse positions say of the velocity is less than what the receiver measured.
TEST(FitMotion, VelocitiesCountWherePositionsAreCoarse) {
  const double with = fit(fixes_of(1, 1, true)).covariance(0, 0);
  const double without = fit(fixes_of(1, 1, false)).covariance(0, 0);
  EXPECT_LT(with, 0.1 * without);
  EXPECT_EQ(fit(fixes_of(0.02, 1, true)).covariance(5, 5),
            fit(fixes_of(0.02, 1, false)).covariance(5, 5));
}

}  // namespace
}  // namespace foucault::alignment
