#include "foucault/diagnosis/imu_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kStep = 10'000'000;

/// A vehicle on a rough road at 100 Hz.
class ImuGuardTest : public ::testing::Test {
 protected:
  Vector3d draw(double sigma) {
    return sigma * Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  static ImuIncrement increment(int64_t k, const Vector3d& gyro, const Vector3d& accel) {
    ImuIncrement out;
    out.t_begin_ns = k * kStep;
    out.t_end_ns = (k + 1) * kStep;
    out.dtheta_b = gyro * out.dt();
    out.dvel_b = accel * out.dt();
    return out;
  }

  ImuIncrement rough(int64_t k) {
    return increment(k, draw(0.01), Vector3d(0, 0, -9.8) + draw(0.2));
  }

  /// How many of the samples [begin, end) are used.
  template <class Make>
  int used(int64_t begin, int64_t end, const Make& make) {
    int count = 0;
    for (int64_t k = begin; k < end; ++k) count += guard_.look_at(make(k)).increment.has_value();
    return count;
  }

  ImuGuard guard_;
  std::mt19937 rng_{7};
  std::normal_distribution<double> normal_;
};

TEST_F(ImuGuardTest, NoiseIsUsed) {
  EXPECT_EQ(used(0, 2000, [&](int64_t k) { return rough(k); }), 2000);
  EXPECT_THAT(guard_.summary(), IsEmpty());
}

TEST_F(ImuGuardTest, AStraightLineWithoutNoiseWasInterpolated) {
  used(0, 500, [&](int64_t k) { return rough(k); });
  const Vector3d gyro = draw(0.01), gyro_slope = draw(1e-4);
  const Vector3d accel = Vector3d(0, 0, -9.8) + draw(0.2), accel_slope = draw(2e-3);
  const int bridged = used(500, 650, [&](int64_t k) {
    const double t = static_cast<double>(k - 500);
    return increment(k, gyro + t * gyro_slope, accel + t * accel_slope);
  });
  EXPECT_LE(bridged, 12);
  EXPECT_EQ(used(650, 1000, [&](int64_t k) { return rough(k); }), 350);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("interpolated over lost data")));
}

/// Values that stand still are coarse sensors at rest; those without noise all along a simulation.
TEST_F(ImuGuardTest, RestOfACoarseSensorIsUsed) {
  used(0, 500, [&](int64_t k) { return rough(k); });
  EXPECT_EQ(used(500, 700,
                 [&](int64_t k) {
                   return increment(k, Vector3d::Zero(), {0, 0, -9.8});
                 }),
            200);
}

TEST_F(ImuGuardTest, SmoothMotionWithoutNoiseIsUsed) {
  EXPECT_EQ(used(0, 3000,
                 [&](int64_t k) {
                   const double t = 0.01 * static_cast<double>(k);
                   const Vector3d wave(std::sin(t), std::cos(0.7 * t), std::sin(0.3 * t));
                   return increment(k, 0.2 * wave, Vector3d(0, 0, -9.8) + wave);
                 }),
            3000);
}

TEST_F(ImuGuardTest, CornersWithoutNoiseAreUsed) {
  EXPECT_EQ(used(0, 3000,
                 [&](int64_t k) {
                   const double t = 0.01 * static_cast<double>(k % 100);
                   const double ramp = k / 100 % 2 == 0 ? t : 1 - t;
                   return increment(k, Vector3d::Constant(ramp), Vector3d::Constant(-9.8 - ramp));
                 }),
            3000);
}

TEST_F(ImuGuardTest, WhatIsNotFiniteOrComesBackIsLeftOut) {
  used(0, 100, [&](int64_t k) { return rough(k); });
  ImuIncrement bad = rough(100);
  bad.dvel_b.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(guard_.look_at(bad).increment);
  EXPECT_FALSE(guard_.look_at(rough(50)).increment);
  EXPECT_TRUE(guard_.look_at(rough(101)).increment);
  ImuIncrement huge = rough(102);
  huge.dtheta_b.x() = 1e10;  // no sensor measures that
  EXPECT_FALSE(guard_.look_at(huge).increment);
  EXPECT_THAT(guard_.summary(), ElementsAre(HasSubstr("2 IMU samples are not finite"),
                                            HasSubstr("do not come after the one before")));
}

/// While the other axes turn on, a gyroscope that repeats itself is stuck.
TEST_F(ImuGuardTest, AStuckAxisIsLeftOutAndNamed) {
  used(0, 500, [&](int64_t k) { return rough(k); });
  std::string said;
  int left_out = 0;
  for (int64_t k = 500; k < 700; ++k) {
    ImuIncrement stuck = rough(k);
    stuck.dtheta_b.z() = 0.3 * stuck.dt();
    const ImuGuard::Verdict verdict = guard_.look_at(stuck);
    left_out += !verdict.increment;
    said += verdict.notice;
  }
  EXPECT_GE(left_out, 190);
  EXPECT_THAT(said, HasSubstr("gyroscope axis z"));
}

}  // namespace
}  // namespace foucault::diagnosis
