#include "foucault/simulation/imu_simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "foucault/core/so3.h"
#include "foucault/simulation/scenario.h"

namespace foucault::simulation {
namespace {

const Eigen::Quaterniond kSame = Eigen::Quaterniond::Identity();

Trajectory city(double duration = 200) {
  ScenarioOptions options;
  options.duration_s = duration;
  return make_trajectory(options);
}

ImuIncrement nothing(int64_t t_ns, double dt) {
  ImuIncrement increment;
  increment.t_begin_ns = t_ns;
  increment.t_end_ns = t_ns + std::llround(dt * 1e9);
  return increment;
}

std::vector<ImuIncrement> run(const imu::ImuNoise& noise, const ImuFlaws& flaws, int64_t seed,
                              const ImuIncrement& exact, int count) {
  ImuErrors errors(noise, flaws, seed);
  std::vector<ImuIncrement> result;
  for (int i = 0; i < count; ++i) result.push_back(errors.apply(exact));
  return result;
}

double mean_square(const std::vector<Eigen::Vector3d>& values) {
  double sum = 0;
  for (const Eigen::Vector3d& value : values) sum += value.squaredNorm() / 3;
  return sum / static_cast<double>(values.size());
}

TEST(ExactIncrement, IsTheIntegralOfTheRates) {
  const Trajectory truth = city();
  // Against Simpson's rule with a thousand pieces, exact to h^4 ~ 1e-20.
  const double begin = 70.0, dt = 0.02, h = dt / 1000;
  Eigen::Vector3d angle = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  for (int i = 0; i < 1000; ++i) {
    const double t = begin + i * h;
    const Motion a = truth.at(t), m = truth.at(t + h / 2), b = truth.at(t + h);
    angle += h / 6 * (a.omega_iv_v + 4 * m.omega_iv_v + b.omega_iv_v);
    velocity += h / 6 * (a.f_v + 4 * m.f_v + b.f_v);
  }
  const ImuIncrement increment = exact_increment(truth, kSame, 0, 70'000'000'000, 70'020'000'000);
  EXPECT_LT((increment.dtheta_b - angle).norm(), 1e-15);
  EXPECT_LT((increment.dvel_b - velocity).norm(), 1e-13);
}

TEST(ExactIncrement, PartsSumToTheWhole) {
  const Trajectory truth = city();
  // Seconds of some 100 s are rounded to 1e-14: times a jerk of a few m/s^3, times dt, and f
  // itself to 1e-15.
  for (int64_t t = 60'000'000'000; t < 160'000'000'000; t += 777'000'000) {
    const ImuIncrement whole = exact_increment(truth, kSame, 0, t, t + 5'000'000);
    const ImuIncrement a = exact_increment(truth, kSame, 0, t, t + 1'300'000);
    const ImuIncrement b = exact_increment(truth, kSame, 0, t + 1'300'000, t + 5'000'000);
    EXPECT_LT((a.dtheta_b + b.dtheta_b - whole.dtheta_b).norm(), 1e-16);
    EXPECT_LT((a.dvel_b + b.dvel_b - whole.dvel_b).norm(), 5e-15);
  }
}

TEST(ExactIncrement, TurnsWithTheMounting) {
  const Trajectory truth = city();
  const Eigen::Quaterniond q_v_b = so3::from_euler({0.3, -0.2, 2.0});
  const ImuIncrement straight = exact_increment(truth, kSame, 1000, 70'000'001'000, 70'005'001'000);
  const ImuIncrement turned = exact_increment(truth, q_v_b, 1000, 70'000'001'000, 70'005'001'000);
  EXPECT_LT((q_v_b * turned.dtheta_b - straight.dtheta_b).norm(), 1e-16);
  EXPECT_LT((q_v_b * turned.dvel_b - straight.dvel_b).norm(), 1e-16);
}

TEST(ExactIncrement, SampleTimesLengthIsTheIncrement) {
  const ImuIncrement increment = exact_increment(city(), kSame, 0, 70'000'000'000, 70'005'000'000);
  const imu::ImuSample sample = interval_mean_sample(increment);
  EXPECT_EQ(sample.t_ns, increment.t_end_ns);
  EXPECT_LT((sample.gyro_b * 0.005 - increment.dtheta_b).norm(), 1e-18);
  EXPECT_LT((sample.accel_b * 0.005 - increment.dvel_b).norm(), 1e-16);
}

TEST(ImuErrors, NoneLeaveTheIncrementAsItIs) {
  const ImuIncrement exact = exact_increment(city(), kSame, 0, 70'000'000'000, 70'005'000'000);
  const ImuIncrement measured = run(imu::ImuNoise{}, {}, 1, exact, 1).front();
  EXPECT_EQ(measured.dtheta_b, exact.dtheta_b);
  EXPECT_EQ(measured.dvel_b, exact.dvel_b);
}

// Sums of n white increments have variance density^2 n dt, for any n (the -1/2 slope of an Allan
// plot). With 1000 sums of 3 axes the variance is known to 2.6 %; 10 % is four sigma.
TEST(ImuErrors, WhiteNoiseHasItsDensityOverAnyTime) {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 3e-5;
  noise.accel_noise_density = 2e-3;
  const double dt = 0.005;
  const std::vector<ImuIncrement> samples = run(noise, {}, 7, nothing(0, dt), 100'000);
  for (int n : {1, 10, 100}) {
    std::vector<Eigen::Vector3d> gyro, accel;
    for (int i = 0; i < 1000; ++i) {
      Eigen::Vector3d angle = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
      for (int k = i * n; k < (i + 1) * n; ++k) {
        angle += samples[k].dtheta_b;
        velocity += samples[k].dvel_b;
      }
      gyro.push_back(angle);
      accel.push_back(velocity);
    }
    EXPECT_NEAR(mean_square(gyro) / (9e-10 * n * dt), 1, 0.1);
    EXPECT_NEAR(mean_square(accel) / (4e-6 * n * dt), 1, 0.1);
  }
}

// 2000 steady-state starts of 3 axes: the variance is known to 1.8 %, a correlation to 1.3 %.
TEST(ImuErrors, BiasIsGaussMarkovWhateverTheStep) {
  imu::ImuNoise noise;
  noise.gyro_bias_sigma = 1e-5;
  noise.accel_bias_sigma = 1e-3;
  noise.bias_tau = 100;
  for (const double dt : {1.0, 25.0}) {
    std::vector<Eigen::Vector3d> first, later;
    double product = 0;
    for (int seed = 0; seed < 2000; ++seed) {
      ImuErrors errors(noise, {}, seed);
      first.push_back(errors.bias().gyro);
      for (double t = 0; t < 50; t += dt) errors.apply(nothing(0, dt));
      later.push_back(errors.bias().gyro);
      product += first.back().dot(later.back()) / 3 / 2000;
    }
    EXPECT_NEAR(mean_square(first) / 1e-10, 1, 0.08);
    EXPECT_NEAR(mean_square(later) / 1e-10, 1, 0.08);
    EXPECT_NEAR(product / 1e-10, std::exp(-0.5), 0.06);
  }
}

TEST(ImuErrors, TurnOnBiasIsConstantWithItsSigma) {
  imu::ImuNoise noise;
  noise.gyro_turn_on_sigma = 5e-4;
  noise.accel_turn_on_sigma = 1e-2;
  std::vector<Eigen::Vector3d> gyro, accel;
  for (int seed = 0; seed < 2000; ++seed) {
    ImuErrors errors(noise, {}, seed);
    const state::ImuBias bias = errors.bias();
    errors.apply(nothing(0, 100));
    EXPECT_EQ(errors.bias().gyro, bias.gyro);
    gyro.push_back(bias.gyro);
    accel.push_back(bias.accel);
  }
  EXPECT_NEAR(mean_square(gyro) / 25e-8, 1, 0.08);
  EXPECT_NEAR(mean_square(accel) / 1e-4, 1, 0.08);
}

TEST(ImuErrors, RecordedBiasIsTheOneInTheIncrements) {
  imu::ImuNoise noise;
  noise.gyro_bias_sigma = 1e-5;
  noise.accel_bias_sigma = 1e-3;
  noise.gyro_turn_on_sigma = 5e-4;
  noise.accel_turn_on_sigma = 1e-2;
  noise.bias_tau = 100;
  ImuErrors errors(noise, {}, 3);
  for (int i = 0; i < 100; ++i) {
    const state::ImuBias before = errors.bias();
    const ImuIncrement measured = errors.apply(nothing(0, 0.5));
    const state::ImuBias after = errors.bias();
    EXPECT_LT((measured.dtheta_b - 0.25 * (before.gyro + after.gyro)).norm(), 1e-18);
    EXPECT_LT((measured.dvel_b - 0.25 * (before.accel + after.accel)).norm(), 1e-16);
  }
}

TEST(ImuErrors, ScaleFactorsAreConstantFactorsOfEachAxis) {
  ImuIncrement exact = nothing(0, 0.005);
  exact.dtheta_b = {1e-3, -2e-3, 3e-3};
  exact.dvel_b = {0.01, 0.02, -0.05};
  std::vector<Eigen::Vector3d> gyro, accel;
  for (int seed = 0; seed < 2000; ++seed) {
    const std::vector<ImuIncrement> measured = run(imu::ImuNoise{}, {300e-6}, seed, exact, 2);
    EXPECT_EQ(measured[0].dtheta_b, measured[1].dtheta_b);
    gyro.push_back((measured[0].dtheta_b - exact.dtheta_b).cwiseQuotient(exact.dtheta_b));
    accel.push_back((measured[0].dvel_b - exact.dvel_b).cwiseQuotient(exact.dvel_b));
  }
  EXPECT_NEAR(mean_square(gyro) / 9e-8, 1, 0.08);
  EXPECT_NEAR(mean_square(accel) / 9e-8, 1, 0.08);
}

/// M of an IMU, by columns: what it makes of an increment along each axis.
struct Matrices {
  explicit Matrices(ImuErrors errors) {
    for (int k = 0; k < 3; ++k) {
      ImuIncrement exact = nothing(0, 0.005);
      exact.dtheta_b = exact.dvel_b = Eigen::Vector3d::Unit(k);
      const ImuIncrement measured = errors.apply(exact);
      gyro.col(k) = measured.dtheta_b;
      accel.col(k) = measured.dvel_b;
    }
  }
  Eigen::Matrix3d gyro, accel;
};

// 2000 matrices: a variance of 6 terms is known to 1.3 %, of 3 to 1.8 %, of one to 3.2 %.
TEST(ImuErrors, CrossAxisTermsAreOffTheDiagonal) {
  ImuFlaws flaws;
  flaws.cross_axis_sigma = 800e-6;
  Eigen::Matrix3d gyro = Eigen::Matrix3d::Zero(), accel = Eigen::Matrix3d::Zero();
  for (int seed = 0; seed < 2000; ++seed) {
    const Matrices m(ImuErrors(imu::ImuNoise{}, flaws, seed));
    gyro += (m.gyro - Eigen::Matrix3d::Identity()).cwiseAbs2() / 2000;
    accel += (m.accel - Eigen::Matrix3d::Identity()).cwiseAbs2() / 2000;
  }
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(gyro(i, k) / 64e-8, i == k ? 0 : 1, 0.13) << i << k;
      EXPECT_NEAR(accel(i, k) / 64e-8, i < k ? 1 : 0, 0.13) << i << k;
    }
  }
}

TEST(ImuErrors, ScaleFactorsAndCrossAxisTermsAdd) {
  const Matrices both(ImuErrors(imu::ImuNoise{}, {1e-3, 8e-4}, 3));
  const Matrices scale(ImuErrors(imu::ImuNoise{}, {1e-3, 0}, 3));
  const Matrices cross(ImuErrors(imu::ImuNoise{}, {0, 8e-4}, 3));
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(both.gyro.isApprox(scale.gyro + cross.gyro - one, 1e-14));
  EXPECT_TRUE(both.accel.isApprox(scale.accel + cross.accel - one, 1e-14));
}

TEST(ImuErrors, RectificationGrowsWithTheSpeedSquared) {
  ImuFlaws flaws;
  flaws.rectification = 2e-3;
  Eigen::Vector3d signs = Eigen::Vector3d::Zero();
  for (int seed = 0; seed < 400; ++seed) {
    ImuErrors errors(imu::ImuNoise{}, flaws, seed);
    errors.apply(nothing(0, 0.5), 15);
    const Eigen::Vector3d at_15 = errors.bias().accel;
    EXPECT_TRUE(at_15.cwiseAbs().isConstant(2e-3));
    errors.apply(nothing(0, 0.5), 5);
    EXPECT_TRUE(errors.bias().accel.isApprox(at_15 / 9));
    EXPECT_EQ(errors.bias().gyro, Eigen::Vector3d::Zero());
    const ImuIncrement slower = errors.apply(nothing(0, 0.5), 0);
    EXPECT_TRUE(slower.dvel_b.isApprox(0.25 * at_15 / 9));
    EXPECT_EQ(errors.bias().accel, Eigen::Vector3d::Zero());
    signs += at_15 / 2e-3;
  }
  EXPECT_LT(signs.cwiseAbs().maxCoeff(), 80);  // sigma 20
}

// The difference two errors make is the sum of what each makes alone, draw by draw.
TEST(ImuErrors, SwitchingOneOnLeavesTheDrawsOfTheOthers) {
  const ImuIncrement exact = exact_increment(city(), kSame, 0, 70'000'000'000, 70'005'000'000);
  const imu::ImuNoise full = imu::imu_preset("ADIS16465");
  imu::ImuNoise white, bias = full;
  white.gyro_noise_density = full.gyro_noise_density;
  white.accel_noise_density = full.accel_noise_density;
  bias.gyro_noise_density = bias.accel_noise_density = 0;
  const auto together = run(full, {1e-4, 2e-4}, 5, exact, 50);
  const auto white_only = run(white, {}, 5, exact, 50);
  const auto bias_only = run(bias, {}, 5, exact, 50);
  const auto scale_only = run(imu::ImuNoise{}, {1e-4, 0}, 5, exact, 50);
  const auto cross_only = run(imu::ImuNoise{}, {0, 2e-4}, 5, exact, 50);
  for (std::size_t i = 0; i < together.size(); ++i) {
    const Eigen::Vector3d angle = white_only[i].dtheta_b + bias_only[i].dtheta_b +
                                  scale_only[i].dtheta_b + cross_only[i].dtheta_b -
                                  3 * exact.dtheta_b;
    const Eigen::Vector3d velocity = white_only[i].dvel_b + bias_only[i].dvel_b +
                                     scale_only[i].dvel_b + cross_only[i].dvel_b - 3 * exact.dvel_b;
    EXPECT_LT((together[i].dtheta_b - angle).norm(), 1e-17);
    EXPECT_LT((together[i].dvel_b - velocity).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace foucault::simulation
