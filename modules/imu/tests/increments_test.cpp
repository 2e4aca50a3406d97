#include "foucault/imu/increments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"

namespace foucault::imu {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int64_t kStart = 1'700'000'000'000'000'000;
constexpr int64_t kMillisecond = 1'000'000;

ImuSample sample_at(int64_t offset_ns, const Vector3d& gyro = Vector3d(0.1, -0.2, 0.3),
                    const Vector3d& accel = Vector3d(0.5, 0.1, -9.8)) {
  return {kStart + offset_ns, gyro, accel};
}

TEST(BegunAt, KeepsTheRates) {
  ImuIncrement increment;
  increment.t_begin_ns = kStart;
  increment.t_end_ns = kStart + 10 * kMillisecond;
  increment.dtheta_b = Vector3d(0.01, 0, 0);
  increment.dvel_b = Vector3d(0, 0, -0.1);
  const ImuIncrement longer = begun_at(increment, kStart - 5 * kMillisecond);
  EXPECT_EQ(longer.t_end_ns, increment.t_end_ns);
  EXPECT_NEAR(longer.dt(), 0.015, 1e-12);
  EXPECT_TRUE(longer.dtheta_b.isApprox(Vector3d(0.015, 0, 0), 1e-12));
  EXPECT_TRUE(longer.dvel_b.isApprox(Vector3d(0, 0, -0.15), 1e-12));
}

TEST(Incrementer, IntervalMeanCoversTheIntervalThatEndsAtTheStamp) {
  Incrementer incrementer(SampleKind::interval_mean);
  EXPECT_FALSE(incrementer.add(sample_at(0)));
  const auto increment =
      incrementer.add(sample_at(10 * kMillisecond, Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
  ASSERT_TRUE(increment);
  EXPECT_EQ(increment->t_begin_ns, kStart);
  EXPECT_EQ(increment->t_end_ns, kStart + 10 * kMillisecond);
  EXPECT_TRUE(increment->dtheta_b.isApprox(Vector3d(0.01, 0.02, 0.03), 1e-15));
  EXPECT_TRUE(increment->dvel_b.isApprox(Vector3d(0.04, 0.05, 0.06), 1e-15));
  EXPECT_EQ(increment->extra_gyro_noise_density, 0);
}

TEST(Incrementer, InstantaneousIsTheTrapezoid) {
  Incrementer incrementer(SampleKind::instantaneous);
  EXPECT_FALSE(incrementer.add(sample_at(0, Vector3d(1, 0, 0), Vector3d(0, 0, -10))));
  const auto increment =
      incrementer.add(sample_at(10 * kMillisecond, Vector3d(3, 0, 0), Vector3d(0, 0, -8)));
  ASSERT_TRUE(increment);
  EXPECT_NEAR(increment->dtheta_b.x(), 0.02, 1e-15);
  EXPECT_NEAR(increment->dvel_b.z(), -0.09, 1e-15);
}

/// The increments of samples at the given stamps.
std::vector<ImuIncrement> increments_of(SampleKind kind, const std::vector<int64_t>& offsets) {
  Incrementer incrementer(kind);
  std::vector<ImuIncrement> all;
  for (const int64_t offset : offsets) {
    if (const auto increment = incrementer.add(sample_at(offset))) all.push_back(*increment);
  }
  return all;
}

int holes(const std::vector<ImuIncrement>& increments) {
  int count = 0;
  for (std::size_t i = 1; i < increments.size(); ++i) {
    count += increments[i].t_begin_ns != increments[i - 1].t_end_ns ? 1 : 0;
  }
  return count;
}

TEST(Incrementer, MissingSamplesLeaveAHoleOfTheirLength) {
  for (const SampleKind kind : {SampleKind::interval_mean, SampleKind::instantaneous}) {
    std::vector<int64_t> offsets;
    for (int i = 0; i < 100; ++i) {
      if (i < 50 || i >= 80) offsets.push_back(i * 10 * kMillisecond);
    }
    const std::vector<ImuIncrement> increments = increments_of(kind, offsets);
    ASSERT_EQ(holes(increments), 1);
    const ImuIncrement& before = increments[48];
    const ImuIncrement& after = increments[49];
    EXPECT_EQ(before.t_end_ns, kStart + 490 * kMillisecond);
    EXPECT_EQ(after.t_begin_ns, kStart + 790 * kMillisecond);
    EXPECT_EQ(after.t_end_ns, kStart + 800 * kMillisecond);
    EXPECT_TRUE(after.dvel_b.isApprox(0.01 * Vector3d(0.5, 0.1, -9.8), 1e-14));
  }
}

TEST(Incrementer, JitterOfAMillisecondCounterLeavesNoHole) {
  std::mt19937 rng{42};
  std::uniform_int_distribution<int64_t> interval(8, 11);
  std::vector<int64_t> offsets{0};
  for (int i = 0; i < 5000; ++i) offsets.push_back(offsets.back() + interval(rng) * kMillisecond);
  for (const SampleKind kind : {SampleKind::interval_mean, SampleKind::instantaneous}) {
    const std::vector<ImuIncrement> increments = increments_of(kind, offsets);
    EXPECT_EQ(increments.size(), 5000u);
    EXPECT_EQ(holes(increments), 0);
  }
}

TEST(Incrementer, ALogThatBeginsWithAHoleDoesNotTeachIt) {
  std::vector<int64_t> offsets{0};
  for (int i = 0; i < 50; ++i) offsets.push_back((1920 + 10 * i) * kMillisecond);
  const std::vector<ImuIncrement> increments = increments_of(SampleKind::interval_mean, offsets);
  ASSERT_FALSE(increments.empty());
  EXPECT_GE(increments.size(), 48u);
  EXPECT_GE(increments.front().t_begin_ns, kStart + 1920 * kMillisecond);
  for (const ImuIncrement& increment : increments) EXPECT_NEAR(increment.dt(), 0.01, 1e-12);
  EXPECT_EQ(holes(increments), 0);
}

TEST(Incrementer, AdaptsToANewRate) {
  std::vector<int64_t> offsets{0};
  for (int i = 0; i < 40; ++i) offsets.push_back(offsets.back() + 5 * kMillisecond);
  for (int i = 0; i < 40; ++i) offsets.push_back(offsets.back() + 10 * kMillisecond);
  const std::vector<ImuIncrement> increments = increments_of(SampleKind::interval_mean, offsets);
  EXPECT_EQ(holes({increments.end() - 25, increments.end()}), 0);
  EXPECT_NEAR(increments.back().dt(), 0.01, 1e-12);
}

TEST(Incrementer, SlowImuIsAcceptedOnceItsIntervalRepeats) {
  std::vector<int64_t> offsets;
  for (int i = 0; i < 10; ++i) offsets.push_back(i * 200 * kMillisecond);
  const std::vector<ImuIncrement> increments = increments_of(SampleKind::interval_mean, offsets);
  ASSERT_EQ(increments.size(), 7u);
  EXPECT_EQ(holes(increments), 0);
}

TEST(Incrementer, RefusesStampsThatDoNotIncrease) {
  for (const int64_t second : {int64_t{0}, -kMillisecond}) {
    Incrementer incrementer(SampleKind::interval_mean);
    incrementer.add(sample_at(0));
    try {
      incrementer.add(sample_at(second));
      FAIL() << "accepted";
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("2023-11-14T22:13:20.000Z"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Incrementer, RefusesValuesThatAreNotFinite) {
  const Vector3d good(0, 0, 1);
  const Vector3d bad(0, std::nan(""), 0);
  const Vector3d infinite(0, 0, INFINITY);
  for (const ImuSample& sample :
       {sample_at(0, bad, good), sample_at(0, good, bad), sample_at(0, good, infinite)}) {
    Incrementer incrementer(SampleKind::instantaneous);
    EXPECT_THROW(incrementer.add(sample), DataError);
  }
}

TEST(Split, PartsSumUpToTheWhole) {
  ImuIncrement whole;
  whole.t_begin_ns = kStart;
  whole.t_end_ns = kStart + 7 * kMillisecond;
  whole.dtheta_b = Vector3d(0.123456789, -1e-7, 3);
  whole.dvel_b = Vector3d(-0.3, 17, 1e-9);
  whole.extra_gyro_noise_density = 0.1;
  whole.extra_accel_noise_density = 0.2;
  const auto [first, second] = split(whole, kStart + 2 * kMillisecond);
  EXPECT_EQ(first.t_begin_ns, whole.t_begin_ns);
  EXPECT_EQ(first.t_end_ns, second.t_begin_ns);
  EXPECT_EQ(second.t_end_ns, whole.t_end_ns);
  EXPECT_TRUE(first.dtheta_b.isApprox(whole.dtheta_b * 2 / 7, 1e-15));
  const double rounding = std::numeric_limits<double>::epsilon();
  EXPECT_TRUE((first.dtheta_b + second.dtheta_b).isApprox(whole.dtheta_b, rounding));
  EXPECT_TRUE((first.dvel_b + second.dvel_b).isApprox(whole.dvel_b, rounding));
  EXPECT_EQ(first.extra_gyro_noise_density, 0.1);
  EXPECT_EQ(second.extra_accel_noise_density, 0.2);
}

TEST(Split, RefusesAStampThatIsNotInside) {
  ImuIncrement whole;
  whole.t_begin_ns = kStart;
  whole.t_end_ns = kStart + 10;
  EXPECT_THROW(split(whole, kStart), std::invalid_argument);
  EXPECT_THROW(split(whole, kStart + 10), std::invalid_argument);
}

/// Motion with rates linear in time, w = w0 + w1 t and f = f0 + f1 t: the model behind (15), (18).
struct LinearRates {
  Vector3d w0{0.8, -0.5, 0.3}, w1{-2, 1.5, 2.5}, f0{1, 2, -9.8}, f1{5, -8, 3};

  Vector3d dtheta(double begin, double end) const {
    return w0 * (end - begin) + 0.5 * w1 * (end * end - begin * begin);
  }
  Vector3d dvel(double begin, double end) const {
    return f0 * (end - begin) + 0.5 * f1 * (end * end - begin * begin);
  }
};

struct Truth {
  Quaterniond rotation = Quaterniond::Identity();
  Vector3d velocity = Vector3d::Zero();
};

/// Attitude and velocity gained over [0, T] in the axes at 0, by midpoints of tiny steps.
Truth integrate_finely(const LinearRates& motion, double T) {
  constexpr int kSteps = 20000;  // error (T/steps)^2: 1e-9 of the terms under test
  Truth truth;
  const double h = T / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = (i + 0.5) * h;
    const Vector3d half = 0.5 * h * (motion.w0 + motion.w1 * (middle - 0.25 * h));
    truth.velocity += h * (truth.rotation * so3::exp(half) * (motion.f0 + motion.f1 * middle));
    truth.rotation = truth.rotation * so3::exp(h * (motion.w0 + motion.w1 * middle));
  }
  return truth;
}

struct Errors {
  double rotation = 0;
  double velocity = 0;
};

Errors errors_of_corrections(double previous_T, double T) {
  const LinearRates motion;
  const double scale = previous_increment_scale(previous_T, T);
  const Vector3d previous_dtheta = scale * motion.dtheta(-previous_T, 0);
  const Vector3d previous_dvel = scale * motion.dvel(-previous_T, 0);
  const Truth truth = integrate_finely(motion, T);
  const Vector3d rotation = rotation_with_coning(previous_dtheta, motion.dtheta(0, T));
  const Vector3d velocity = velocity_with_sculling(previous_dtheta, previous_dvel,
                                                   motion.dtheta(0, T), motion.dvel(0, T));
  return {(rotation - so3::log(truth.rotation)).norm(), (velocity - truth.velocity).norm()};
}

TEST(ConingAndSculling, WhatIsLeftShrinksWithTheNextOrder) {
  // Without the coning term the rotation vector errs by T^3 |w0 x w1| / 12, with it by O(T^5)
  // here (the T^4 term vanishes for linear rates). The velocity's error is the second-order
  // rotation (T^3), which (18) leaves out: halving T must divide the errors by at least 16 and
  // by 8.
  const Errors coarse = errors_of_corrections(0.04, 0.04);
  const Errors fine = errors_of_corrections(0.02, 0.02);
  EXPECT_GT(coarse.rotation / fine.rotation, 15);
  EXPECT_GT(coarse.velocity / fine.velocity, 7);
}

TEST(ConingAndSculling, BeatLeavingThemOut) {
  const LinearRates motion;
  const double T = 0.02;
  const Truth truth = integrate_finely(motion, T);
  const double plain_rotation = (motion.dtheta(0, T) - so3::log(truth.rotation)).norm();
  EXPECT_LT(errors_of_corrections(T, T).rotation, 0.05 * plain_rotation);
}

TEST(ConingAndSculling, ScaleMakesUnequalLengthsAsGoodAsEqualOnes) {
  const Errors equal = errors_of_corrections(0.01, 0.01);
  for (const double previous : {0.002, 0.005, 0.02, 0.05}) {
    EXPECT_LT(errors_of_corrections(previous, 0.01).rotation, 2 * equal.rotation + 1e-12);
    EXPECT_LT(errors_of_corrections(previous, 0.01).velocity, 2 * equal.velocity + 1e-12);
  }
  EXPECT_DOUBLE_EQ(previous_increment_scale(0.01, 0.01), 1);
}

}  // namespace
}  // namespace foucault::imu
