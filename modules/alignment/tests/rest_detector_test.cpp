#include "../src/rest_detector.h"

#include <gtest/gtest.h>

#include <functional>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"

namespace foucault::alignment {
namespace {

using Eigen::Vector3d;

constexpr int64_t kStep = 10'000'000;  // [ns]
const Geodetic kPlace{48 * kDegree, 9 * kDegree, 300};
const Vector3d kForce(0.3, -0.2, -9.8);

class RestDetectorTest : public ::testing::Test {
 protected:
  GnssFix fix_at(double t, const Vector3d& d_n = Vector3d::Zero()) const {
    GnssFix fix;
    fix.t_ns = nanoseconds(t);
    fix.antenna = geodesy::displaced(kPlace, d_n, geodesy::Place(kPlace));
    fix.position_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    return fix;
  }

  /// To the second `end`, a fix at the begin of each; gives how often it said that the vehicle
  /// rests.
  int run(
      double end, const std::function<Vector3d(double)>& rate_b,
      const std::function<Vector3d(double)>& away_n = [](double) { return Vector3d(0, 0, 0); }) {
    int still = 0;
    for (; now_ns_ < nanoseconds(end); now_ns_ += kStep) {
      const double t = to_seconds(now_ns_);
      if (now_ns_ % kNanosecondsPerSecond == 0) detector_.add(fix_at(t, away_n(t)));
      ImuIncrement increment;
      increment.t_begin_ns = now_ns_;
      increment.t_end_ns = now_ns_ + kStep;
      increment.dtheta_b = increment.dt() * rate_b(t + 0.005);
      increment.dvel_b = increment.dt() * kForce;
      still += detector_.add(increment) ? 1 : 0;
    }
    return still;
  }
  int rest(double end) {
    return run(end, [](double) { return Vector3d(1e-3, 2e-3, 3e-3); });
  }

  RestDetector detector_{3, 60};
  int64_t now_ns_ = 0;
};

TEST_F(RestDetectorTest, MeansAreThoseOfTheRest) {
  EXPECT_EQ(rest(10), 10);
  EXPECT_TRUE(detector_.established());
  EXPECT_FALSE(detector_.ended());
  const RestMeans means = detector_.means();
  EXPECT_NEAR(means.duration(), 10, 1e-9);
  EXPECT_LT((means.gyro_b - Vector3d(1e-3, 2e-3, 3e-3)).norm(), 1e-12);
  EXPECT_LT((means.accel_b - kForce).norm(), 1e-12);
  EXPECT_LT(means.gyro_variance.norm(), 1e-20);
  EXPECT_EQ(detector_.first_fix()->t_ns, 0);
  EXPECT_EQ(detector_.begin_ns(), 0);
}

TEST_F(RestDetectorTest, IsNotEstablishedByTheImuAlone) {
  const auto without_fixes = [&] {
    for (; now_ns_ < nanoseconds(9); now_ns_ += kStep) {
      ImuIncrement increment;
      increment.t_begin_ns = now_ns_;
      increment.t_end_ns = now_ns_ + kStep;
      increment.dvel_b = increment.dt() * kForce;
      detector_.add(increment);
    }
  };
  without_fixes();
  EXPECT_FALSE(detector_.established());
  EXPECT_FALSE(detector_.first_fix());
}

/// A door is slammed: three seconds are no end, four are.
TEST_F(RestDetectorTest, AShortDisturbanceIsNoEnd) {
  const auto knocked = [](double) { return Vector3d(0.1, 0, 0); };
  rest(10);
  EXPECT_EQ(run(13, knocked), 0);
  EXPECT_EQ(rest(20), 7);
  EXPECT_FALSE(detector_.ended());
  EXPECT_EQ(run(24, knocked), 0);
  EXPECT_TRUE(detector_.ended());
  EXPECT_TRUE(detector_.established());
  EXPECT_LT((detector_.means().gyro_b - Vector3d(1e-3, 2e-3, 3e-3)).norm(), 1e-12);
  EXPECT_EQ(rest(30), 0) << "what follows is another rest";
}

TEST_F(RestDetectorTest, AFixElsewhereEndsIt) {
  rest(10);
  run(
      12, [](double) { return Vector3d(1e-3, 2e-3, 3e-3); },
      [](double t) { return Vector3d(t > 10 ? 0.2 : 0.1, 0, 0); });
  EXPECT_TRUE(detector_.ended());
  EXPECT_NEAR(detector_.means().duration(), 10, 1e-9) << "the last second is left out";
}

TEST_F(RestDetectorTest, ABriefRestThatAFixDeniesBeginsAnew) {
  rest(2);
  GnssFix fast = fix_at(2);
  fast.velocity_n = Vector3d(0.5, 0, 0);
  fast.velocity_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  detector_.add(fast);
  rest(4);
  EXPECT_FALSE(detector_.established());
  fast.velocity_covariance *= 1e4;  // of no consequence at such a sigma
  detector_.add(fast);
  rest(6);
  EXPECT_TRUE(detector_.established());
  EXPECT_EQ(detector_.means().begin_ns, nanoseconds(2));
}

TEST_F(RestDetectorTest, DriftIsNotAveragedOut) {
  const double slope = 2e-5;  // [rad/s^2]
  run(20, [&](double t) { return Vector3d(slope * t, 0, 0); });
  const RestMeans means = detector_.means();
  EXPECT_NEAR(means.gyro_variance.x(), std::pow(slope * 10, 2), 1e-12);  // 10 s between halves
  EXPECT_EQ(means.gyro_variance.y(), 0);
}

TEST_F(RestDetectorTest, RecentMeansKnowTheLastTwentySecondsAlone) {
  run(40, [](double t) { return Vector3d(t < 20 ? 1e-3 : 3e-3, 0, 0); });
  EXPECT_NEAR(detector_.means().gyro_b.x(), 2e-3, 1e-12);
  EXPECT_NEAR(detector_.recent_means().gyro_b.x(), 3e-3, 1e-12);
}

TEST_F(RestDetectorTest, ForgetsARestThatIsTooOld) {
  rest(10);
  run(14, [](double) { return Vector3d(0.1, 0, 0); });
  EXPECT_TRUE(detector_.ended());
  run(80, [](double t) { return Vector3d(0.1 * t, 0, 0); });
  EXPECT_FALSE(detector_.established());
  EXPECT_FALSE(detector_.ended());
  rest(90);
  EXPECT_TRUE(detector_.established());
}

}  // namespace
}  // namespace foucault::alignment
