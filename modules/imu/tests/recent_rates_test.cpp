#include "foucault/imu/recent_rates.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foucault::imu {
namespace {

using Eigen::Vector3d;

/// What instruments with these rates give over the next dt.
class Imu {
 public:
  ImuIncrement next(const Vector3d& gyro_b, const Vector3d& accel_b, double dt) {
    ImuIncrement increment;
    increment.t_begin_ns = t_ns_;
    t_ns_ += static_cast<int64_t>(std::lround(dt * 1e9));
    increment.t_end_ns = t_ns_;
    increment.dtheta_b = increment.dt() * gyro_b;
    increment.dvel_b = increment.dt() * accel_b;
    return increment;
  }

 private:
  int64_t t_ns_ = 1'700'000'000'000'000'000;
};

const Vector3d kGyro(0.1, -0.2, 0.3);
const Vector3d kAccel(0.5, 1, -9.8);

TEST(RecentRates, FirstIncrementIsTheMean) {
  RecentRates rates{0.05};
  EXPECT_EQ(rates.gyro_b, Vector3d::Zero());
  Imu imu;
  rates.add(imu.next(kGyro, kAccel, 0.005));
  EXPECT_LT((rates.gyro_b - kGyro).norm(), 1e-15);
  EXPECT_LT((rates.accel_b - kAccel).norm(), 1e-14);
  EXPECT_DOUBLE_EQ(rates.seen_s, 0.005);
}

/// By the times they last, until the memory is full.
TEST(RecentRates, AreTheMeanOfAllThatIsRemembered) {
  RecentRates rates{0.05};
  Imu imu;
  Vector3d turned = Vector3d::Zero(), gained = Vector3d::Zero();
  double time = 0;
  for (const double dt : {0.005, 0.01, 0.002, 0.02, 0.008}) {
    const ImuIncrement increment = imu.next((1 + 100 * dt) * kGyro, std::cos(time) * kAccel, dt);
    turned += increment.dtheta_b;
    gained += increment.dvel_b;
    time += dt;
    rates.add(increment);
    EXPECT_LT((rates.gyro_b - turned / time).norm(), 1e-14) << time;
    EXPECT_LT((rates.accel_b - gained / time).norm(), 1e-13) << time;
    EXPECT_NEAR(rates.seen_s, time, 1e-15);
  }
}

/// What is older than the memory fades by 1/e in each: of five, 0.7 % are left (0.6 % in steps).
TEST(RecentRates, ForgetWhatIsOlder) {
  RecentRates rates{0.05};
  Imu imu;
  for (int i = 0; i < 100; ++i) rates.add(imu.next(-kGyro, -kAccel, 0.005));
  const auto left = [&] { return (kGyro - rates.gyro_b).norm() / (2 * kGyro.norm()); };
  for (int i = 0; i < 10; ++i) rates.add(imu.next(kGyro, kAccel, 0.005));
  EXPECT_NEAR(left(), std::exp(-1), 0.03);
  for (int i = 0; i < 40; ++i) rates.add(imu.next(kGyro, kAccel, 0.005));
  EXPECT_NEAR(left(), std::exp(-5), 0.002);
  EXPECT_EQ(rates.seen_s, 0.05);
}

/// An increment that lasts longer than the memory is all that is remembered.
TEST(RecentRates, LongIncrementIsAll) {
  RecentRates rates{0.05};
  Imu imu;
  for (int i = 0; i < 100; ++i) rates.add(imu.next(-kGyro, -kAccel, 0.005));
  rates.add(imu.next(kGyro, kAccel, 0.2));
  EXPECT_LT((rates.gyro_b - kGyro).norm(), 1e-15);
  EXPECT_LT((rates.accel_b - kAccel).norm(), 1e-14);
}

/// +-1 rad/s from sample to sample about a mean. With a weight w = dt / memory of the newest, an
/// alternating input is let through by w / (2 - w): 5.3 % at 200 Hz.
TEST(RecentRates, VibrationAveragesOut) {
  RecentRates rates{kLeverArmRateMemory};
  Imu imu;
  double most = 0;
  for (int i = 0; i < 1000; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    rates.add(imu.next(kGyro + sign * Vector3d::Ones(), kAccel, 0.005));
    if (i > 100) most = std::max(most, (rates.gyro_b - kGyro).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(most, 0.06);
  EXPECT_GT(most, 0.01);
  EXPECT_LT((rates.accel_b - kAccel).norm(), 1e-12);
}

/// A turn that grows is followed with a lag of the memory, less half an increment.
TEST(RecentRates, FollowATurn) {
  RecentRates rates{kLeverArmRateMemory};
  Imu imu;
  constexpr double kGrowth = 0.5;  // [rad/s^2]
  double t = 0;
  for (; t < 2; t += 0.01) rates.add(imu.next({0, 0, kGrowth * (t + 0.005)}, kAccel, 0.01));
  EXPECT_NEAR(rates.gyro_b.z(), kGrowth * (t - kLeverArmRateMemory), kGrowth * 0.011);
}

}  // namespace
}  // namespace foucault::imu
