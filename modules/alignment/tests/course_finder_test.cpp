#include "../src/course_finder.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {
namespace {

using Eigen::Vector3d;

constexpr double kOffset = 0.8;   // heading of l's first axis
constexpr double kCourse = -0.3;  // in w
const geodesy::LocalFrame kFrame(Geodetic{48 * kDegree, 9 * kDegree, 300});

/// A straight drive at 10 m/s.
class CourseFinderTest : public ::testing::Test {
 protected:
  static GnssFix fix_at(double t) {
    GnssFix fix;
    fix.t_ns = nanoseconds(t);
    fix.antenna = kFrame.to_geodetic(10 * t * Vector3d(std::cos(kCourse), std::sin(kCourse), 0));
    fix.position_covariance = 1e-4 * Eigen::Matrix3d::Identity();
    fix.quality = FixQuality::fixed_rtk;
    return fix;
  }
  static GnssFix coarse_fix_at(double t) {
    GnssFix fix = fix_at(t);
    fix.position_covariance = 4 * Eigen::Matrix3d::Identity();
    fix.velocity_n = 10 * Vector3d(std::cos(kCourse), std::sin(kCourse), 0);
    fix.velocity_covariance = 1e-2 * Eigen::Matrix3d::Identity();
    return fix;
  }
  static LevelAttitude heading(double in_w) {
    LevelAttitude attitude;
    attitude.q_l_b = so3::from_euler({0, 0, in_w - kOffset});
    return attitude;
  }

  /// Seconds until the finder knows; none within 20.
  std::optional<double> known_after(const std::function<GnssFix(double)>& fix,
                                    const std::function<LevelAttitude(double)>& attitude) {
    for (int k = 0; k <= 40; ++k) {
      found_ = finder_.add(fix(0.5 * k), attitude(0.5 * k));
      if (found_) return 0.5 * k;
    }
    return std::nullopt;
  }
  static LevelAttitude straight(double) { return heading(kCourse); }

  CourseFinder finder_{CourseLimits{}};
  std::optional<HeadingOffset> found_;
};

TEST_F(CourseFinderTest, ThreeCoursesOfASecondTellTheOffset) {
  EXPECT_EQ(known_after(fix_at, straight), 3.0);
  EXPECT_NEAR(found_->offset, kOffset, 1e-5);  // meridians converge
  EXPECT_EQ(found_->courses, 3);
  EXPECT_EQ(found_->begin_ns, 0);
  EXPECT_NEAR(finder_.fastest(), 10, 1e-4);
  // Three courses of 1 cm each end over 10 m, 0.3 deg each of crab, and the mounting.
  const double one = 2e-4 / 100 + std::pow(0.3 * kDegree, 2);
  EXPECT_NEAR(found_->variance, one / 3 + 0.005 * 0.005, 1e-9);
}

TEST_F(CourseFinderTest, CoarsePositionsWithVelocity) {
  EXPECT_TRUE(known_after(coarse_fix_at, straight));
  EXPECT_NEAR(found_->offset, kOffset, 1e-9);
}

TEST_F(CourseFinderTest, TheLeverArmSwingsInATurn) {
  const double rate = 0.05;
  const Vector3d arm(0.5, 1, 0);
  const auto turning = [&](double t) {
    LevelAttitude attitude = heading(rate * t);
    attitude.omega_b = Vector3d(0, 0, rate);
    return attitude;
  };
  const auto fix = [&](double t) {
    GnssFix moved = coarse_fix_at(t);
    const Eigen::Quaterniond q = so3::from_euler({0, 0, rate * t});
    moved.velocity_n = q * Vector3d(10 * Vector3d::UnitX() + Vector3d(0, 0, rate).cross(arm));
    moved.p_b_a = arm;
    return moved;
  };
  EXPECT_TRUE(known_after(fix, turning));
  // The speed counts along the forward axis, the antenna's is 5 cm/s less.
  EXPECT_NEAR(found_->offset, kOffset, 2e-4);
}

TEST_F(CourseFinderTest, IsSilentWhereACourseIsNoHeading) {
  const auto slow = [](double t) { return fix_at(0.2 * t); };
  const auto slow_at = [&](double t) {
    GnssFix fix = slow(t);
    fix.t_ns = nanoseconds(t);
    return fix;
  };
  EXPECT_FALSE(known_after(slow_at, straight));
  finder_ = CourseFinder(CourseLimits{});
  const auto turning = [](double t) { return heading(kCourse + 0.15 * t); };
  EXPECT_FALSE(known_after(fix_at, turning));
  finder_ = CourseFinder(CourseLimits{});
  const auto skidding = [](double t) {
    return heading(kCourse + (std::fmod(t, 4) < 2 ? 0 : 0.06));
  };
  EXPECT_FALSE(known_after(fix_at, skidding)) << "courses that do not agree";
  finder_ = CourseFinder(CourseLimits{});
  const auto uncertain = [](double t) {
    GnssFix fix = fix_at(t);
    fix.position_covariance *= 2500;
    return fix;
  };
  EXPECT_FALSE(known_after(uncertain, straight));
}

TEST_F(CourseFinderTest, BeginsAnewAfterAGapAWorseFixAndAnInterruption) {
  const auto gap = [](double t) { return fix_at(t < 3 ? t : t + 4); };
  EXPECT_EQ(known_after(gap, straight), 6.0);
  finder_ = CourseFinder(CourseLimits{});
  const auto worse = [](double t) {
    GnssFix fix = fix_at(t);
    if (t == 2) fix.quality = FixQuality::float_rtk;
    return fix;
  };
  EXPECT_EQ(known_after(worse, straight), 5.5);
  finder_ = CourseFinder(CourseLimits{});
  for (double t = 0; t < 3; t += 0.5) EXPECT_FALSE(finder_.add(fix_at(t), straight(t)));
  finder_.interrupt();
  EXPECT_FALSE(finder_.add(fix_at(3), straight(3)));
}

}  // namespace
}  // namespace foucault::alignment
