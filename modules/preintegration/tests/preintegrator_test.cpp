#include "foucault/preintegration/preintegrator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "closed_form_motion.h"
#include "dense_preintegrator.h"
#include "foucault/imu/increments.h"

namespace foucault::preintegration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ClosedFormMotion;
using testing::DensePreintegrator;
using testing::preintegrate;
using testing::wuhan_earth;
using namespace state::block;

/// Noise with every part of comparable effect over a second, so that no block hides.
imu::ImuNoise loud_noise() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 2e-3;
  noise.accel_noise_density = 3e-2;
  noise.gyro_bias_sigma = 4e-3;
  noise.accel_bias_sigma = 5e-2;
  noise.bias_tau = 2;
  return noise;
}

/// |A - B| with every entry in units of B's own sigmas.
double normalized_difference(const state::NodeMatrix& A, const state::NodeMatrix& B) {
  const state::NodeVector s = B.diagonal().cwiseSqrt().cwiseInverse();
  return (s.asDiagonal() * (A - B) * s.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(Preintegrator, StructuredFormEqualsDenseProducts) {
  const ClosedFormMotion motion(wuhan_earth());
  const std::vector<ImuIncrement> increments = motion.increments(3, 4, 200);
  const state::ImuBias bias{{0.01, -0.02, 0.015}, {0.1, 0.05, -0.2}};
  DensePreintegrator products(loud_noise(), bias, increments.front());
  for (std::size_t i = 1; i < increments.size(); ++i) products.add(increments[i]);
  const Preintegration dense = products.result();
  const Preintegration structured = preintegrate(increments, loud_noise(), bias);
  // Same arithmetic in another order: rounding only. Everything is below 10 in its unit.
  EXPECT_LT(normalized_difference(structured.covariance, dense.covariance), 1e-12);
  const auto near = [](const auto& a, const auto& b) {
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-12);
  };
  near(structured.by_gyro_bias.dp, dense.by_gyro_bias.dp);
  near(structured.by_accel_bias.dp, dense.by_accel_bias.dp);
  near(structured.by_gyro_bias.dv, dense.by_gyro_bias.dv);
  near(structured.by_accel_bias.dv, dense.by_accel_bias.dv);
  near(structured.by_gyro_bias.dq, dense.by_gyro_bias.dq);
  near(structured.dp, dense.dp);
  near(structured.dv, dense.dv);
  near(structured.dq.coeffs(), dense.dq.coeffs());
}

TEST(Preintegrator, CovarianceApproachesVanLoan) {
  const ClosedFormMotion motion(wuhan_earth());
  const imu::ImuNoise noise = loud_noise();
  // Van Loan on a fine grid, rates constant within 1 ms.
  state::NodeMatrix exact = state::NodeMatrix::Zero();
  for (int k = 0; k < 1000; ++k) {
    const double t = 3 + (k + 0.5) * 1e-3;
    state::NodeMatrix F = state::NodeMatrix::Zero();
    const Matrix3d C = (motion.q(3).conjugate() * motion.q(t)).toRotationMatrix();
    state::part(F, position, velocity).setIdentity();
    state::part(F, velocity, attitude) = -C * so3::skew(motion.specific_force_b(t));
    state::part(F, velocity, accel_bias) = -C;
    state::part(F, attitude, attitude) = -so3::skew(motion.omega_ib_b(t));
    state::part(F, attitude, gyro_bias) = -Matrix3d::Identity();
    state::part(F, gyro_bias, gyro_bias) = -Matrix3d::Identity() / noise.bias_tau;
    state::part(F, accel_bias, accel_bias) = -Matrix3d::Identity() / noise.bias_tau;
    state::NodeVector W = state::NodeVector::Zero();
    state::part(W, velocity).setConstant(std::pow(noise.accel_noise_density, 2));
    state::part(W, attitude).setConstant(std::pow(noise.gyro_noise_density, 2));
    state::part(W, gyro_bias).setConstant(noise.gyro_bias_power());
    state::part(W, accel_bias).setConstant(noise.accel_bias_power());
    using Twice = Eigen::Matrix<double, 2 * state::kNodeSize, 2 * state::kNodeSize>;
    Twice M = Twice::Zero();
    M.topLeftCorner<state::kNodeSize, state::kNodeSize>() = -F;
    M.topRightCorner<state::kNodeSize, state::kNodeSize>() = W.asDiagonal();
    M.bottomRightCorner<state::kNodeSize, state::kNodeSize>() = F.transpose();
    const Twice E = (M * 1e-3).exp();
    const state::NodeMatrix phi =
        E.bottomRightCorner<state::kNodeSize, state::kNodeSize>().transpose();
    exact = phi * exact * phi.transpose() +
            phi * E.topRightCorner<state::kNodeSize, state::kNodeSize>();
  }
  const double at_100 =
      normalized_difference(preintegrate(motion.increments(3, 4, 100), noise).covariance, exact);
  const double at_200 =
      normalized_difference(preintegrate(motion.increments(3, 4, 200), noise).covariance, exact);
  EXPECT_LT(at_200, 5e-3);               // half a percent of a sigma product at the paper's rate
  EXPECT_NEAR(at_100 / at_200, 2, 0.5);  // (42) takes the decay of the noise to first order in dt
}

TEST(Preintegrator, CovarianceMatchesMonteCarlo) {
  const ClosedFormMotion motion(wuhan_earth());
  const imu::ImuNoise noise = loud_noise();
  const std::vector<ImuIncrement> clean = motion.increments(3, 4, 100);
  const Preintegration truth = preintegrate(clean, noise);
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Vector3d(normal(rng), normal(rng), normal(rng)); };

  constexpr int kRuns = 4000;
  state::NodeMatrix sample = state::NodeMatrix::Zero();
  for (int run = 0; run < kRuns; ++run) {
    std::vector<ImuIncrement> noisy = clean;
    Vector3d bg = Vector3d::Zero(), ba = Vector3d::Zero();
    for (std::size_t i = 1; i < noisy.size(); ++i) {
      const double dt = noisy[i].dt();
      const double e = std::exp(-dt / noise.bias_tau);
      const Vector3d bg_before = bg, ba_before = ba;
      bg = e * bg + noise.gyro_bias_sigma * std::sqrt(1 - e * e) * draw();
      ba = e * ba + noise.accel_bias_sigma * std::sqrt(1 - e * e) * draw();
      noisy[i].dtheta_b +=
          noise.gyro_noise_density * std::sqrt(dt) * draw() + 0.5 * dt * (bg_before + bg);
      noisy[i].dvel_b +=
          noise.accel_noise_density * std::sqrt(dt) * draw() + 0.5 * dt * (ba_before + ba);
    }
    const Preintegration measured = preintegrate(noisy, noise);
    state::NodeVector error;  // true minus measured
    error << truth.dp - measured.dp, truth.dv - measured.dv,
        so3::log(measured.dq.conjugate() * truth.dq), bg, ba;
    sample += error * error.transpose() / kRuns;
  }
  // A sample covariance of N runs scatters by 1/sqrt(N) = 1.6 % off the diagonal, 2.2 % on it;
  // four sigma. Signs matter: a wrong one on any correlated block fails by far more.
  EXPECT_LT(normalized_difference(sample, truth.covariance), 4 * std::sqrt(2.0 / kRuns));
}

TEST(Preintegrator, ASingleSampleHasAPositiveCovariance) {
  const ClosedFormMotion motion(wuhan_earth());
  const state::NodeMatrix P =
      preintegrate(motion.increments(3, 3.005, 200), loud_noise()).covariance;
  EXPECT_EQ(Eigen::LLT<state::NodeMatrix>(P).info(), Eigen::Success);
  // White noise over one interval: dt^3/2 by the trapezoid, dt^3/3 exactly.
  EXPECT_NEAR(state::part(P, position, position)(0, 0), 9e-4 * std::pow(0.005, 3) / 2, 1e-12);
}

/// Errors of the sensors at which to integrate.
struct SensorErrors {
  state::ImuBias bias;
  std::optional<state::ImuScale> scale;
};

Preintegration preintegrate_at(const std::vector<ImuIncrement>& increments,
                               const SensorErrors& at) {
  return preintegrate(increments, {}, at.bias, at.scale);
}

const state::ImuBias kBias{{0.01, -0.02, 0.015}, {0.1, 0.05, -0.2}};
/// Large, so that 1 / (1 + scale) in a column shows.
const state::ImuScale kScale{{0.02, -0.03, 0.01}, {-0.01, 0.02, 0.03}};

/// Difference quotient of the deltas by what `shifted` makes of a step.
template <class Shifted>
void expect_derivatives(const DeltaJacobian& J, double size, const Shifted& shifted) {
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const Preintegration plus = shifted(Vector3d(kStep * Vector3d::Unit(axis)));
    const Preintegration minus = shifted(Vector3d(-kStep * Vector3d::Unit(axis)));
    // The step's derivative leaves out how a block enters the 1/12 coning and sculling terms:
    // relative (change of the rate from sample to sample) / 12, here below 1e-5.
    const auto near = [&](const Vector3d& difference, const Vector3d& column, double scale) {
      EXPECT_LT((difference / (2 * kStep) - column).norm(), 2e-5 * scale);
    };
    near(plus.dp - minus.dp, J.dp.col(axis), 0.5 * size);
    near(plus.dv - minus.dv, J.dv.col(axis), size);
    near(so3::log(minus.dq.conjugate() * plus.dq), J.dq.col(axis), 1);
  }
}

void expect_bias_derivatives(const std::vector<ImuIncrement>& increments, const SensorErrors& at) {
  const Preintegration pre = preintegrate_at(increments, at);
  expect_derivatives(pre.by_gyro_bias, 5, [&](const Vector3d& d) {
    SensorErrors shifted = at;
    shifted.bias.gyro += d;
    return preintegrate_at(increments, shifted);
  });
  expect_derivatives(pre.by_accel_bias, 1, [&](const Vector3d& d) {
    SensorErrors shifted = at;
    shifted.bias.accel += d;
    return preintegrate_at(increments, shifted);
  });
}

TEST(Preintegrator, BiasJacobiansAreDerivatives) {
  const std::vector<ImuIncrement> increments =
      ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
  expect_bias_derivatives(increments, {kBias, std::nullopt});
  expect_bias_derivatives(increments, {kBias, kScale});
}

TEST(Preintegrator, ScaleJacobiansAreDerivatives) {
  const std::vector<ImuIncrement> increments =
      ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
  for (const state::ImuScale& scale : {state::ImuScale{}, kScale}) {
    const SensorErrors at{kBias, scale};
    const Preintegration pre = preintegrate_at(increments, at);
    expect_derivatives(pre.by_gyro_scale, 5, [&](const Vector3d& d) {
      SensorErrors shifted = at;
      shifted.scale->gyro += d;
      return preintegrate_at(increments, shifted);
    });
    expect_derivatives(pre.by_accel_scale, 10, [&](const Vector3d& d) {  // 9.8 m/s in a second
      SensorErrors shifted = at;
      shifted.scale->accel += d;
      return preintegrate_at(increments, shifted);
    });
  }
}

TEST(Preintegrator, CrossAxisJacobiansAreDerivatives) {
  const std::vector<ImuIncrement> increments =
      ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
  state::ImuScale crossed = kScale;
  crossed.gyro_cross << 0.01, -0.02, 0.015, -0.01, 0.02, -0.015;
  crossed.accel_cross = {0.02, -0.01, 0.015};
  for (const state::ImuScale& scale : {state::ImuScale{}, crossed}) {
    const SensorErrors at{kBias, scale};
    const Preintegration pre = preintegrate_at(increments, at);
    for (std::size_t i = 0; i < pre.by_gyro_cross.size(); ++i) {
      expect_derivatives(pre.by_gyro_cross[i], 5, [&](const Vector3d& d) {
        SensorErrors shifted = at;
        shifted.scale->gyro_cross.segment<3>(3 * static_cast<Eigen::Index>(i)) += d;
        return preintegrate_at(increments, shifted);
      });
      EXPECT_GT(pre.by_gyro_cross[i].dq.norm(), 0.1) << i;
    }
    expect_derivatives(pre.by_accel_cross, 10, [&](const Vector3d& d) {
      SensorErrors shifted = at;
      shifted.scale->accel_cross += d;
      return preintegrate_at(increments, shifted);
    });
    EXPECT_GT(pre.by_accel_cross.dv.norm(), 1);
  }
}

TEST(Preintegrator, TheTrueScaleGivesBackTheDeltas) {
  const std::vector<ImuIncrement> ideal = ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
  const state::ImuScale scale{{1e-3, -1e-3, 1e-3}, {-1e-3, 1e-3, -1e-3}};
  const std::vector<ImuIncrement> recorded = testing::measured(ideal, kBias, scale);
  const Preintegration truth = preintegrate(ideal);
  const Preintegration pre = preintegrate(recorded, {}, kBias, scale);
  // Rounding of numbers below 10.
  EXPECT_LT((pre.dp - truth.dp).norm(), 1e-13);
  EXPECT_LT((pre.dv - truth.dv).norm(), 1e-13);
  EXPECT_LT((pre.idp - truth.idp).norm(), 1e-13);
  EXPECT_LT((pre.iidp - truth.iidp).norm(), 1e-13);
  EXPECT_LT(so3::log(pre.dq.conjugate() * truth.dq).norm(), 1e-13);
  // Without it 1000 ppm of 9.8 m/s and of 1.2 rad/s, the latter acting on the half of 9.8 m/s.
  const Preintegration without = preintegrate(recorded, {}, kBias);
  EXPECT_GT((without.dv - truth.dv).norm(), 5e-3);
  EXPECT_GT(so3::log(without.dq.conjugate() * truth.dq).norm(), 2e-4);
}

TEST(Preintegrator, AScaleOfZeroChangesNothingAndNoneHasNoJacobians) {
  const std::vector<ImuIncrement> increments =
      ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
  const Preintegration none = preintegrate(increments, loud_noise(), kBias);
  const Preintegration zero = preintegrate(increments, loud_noise(), kBias, state::ImuScale{});
  EXPECT_FALSE(none.scale);
  EXPECT_TRUE(zero.scale);
  EXPECT_EQ(zero.dp, none.dp);
  EXPECT_EQ(zero.dq.coeffs(), none.dq.coeffs());
  EXPECT_EQ(zero.by_gyro_bias.dq, none.by_gyro_bias.dq);
  EXPECT_EQ(zero.covariance, none.covariance);
  for (const DeltaJacobian& J : {none.by_gyro_scale, none.by_accel_scale, none.by_gyro_cross[0],
                                 none.by_gyro_cross[1], none.by_accel_cross})
    EXPECT_TRUE(J.dp.isZero(0) && J.dv.isZero(0) && J.dq.isZero(0));
}

TEST(Preintegrator, SplittingAnIncrementChangesLittle) {
  const ClosedFormMotion motion(wuhan_earth());
  std::vector<ImuIncrement> increments = motion.increments(3, 4, 200);
  const Preintegration whole = preintegrate(increments);
  const std::pair<ImuIncrement, ImuIncrement> parts =
      imu::split(increments[77], increments[77].t_begin_ns + 1'234'567);
  increments[77] = parts.first;
  increments.insert(increments.begin() + 78, parts.second);
  const Preintegration cut = preintegrate(increments);
  // Within a sample the motion is not known better than its linear change: (omega dt)^2 of one
  // velocity increment.
  EXPECT_LT((whole.dv - cut.dv).norm(), 1e-6);
  EXPECT_LT((whole.dp - cut.dp).norm(), 1e-6);
  EXPECT_LT(whole.dq.angularDistance(cut.dq), 1e-7);
}

TEST(Preintegrator, ExtraNoiseOfABridgeAddsToTheSensors) {
  ImuIncrement gap;
  gap.t_end_ns = 500'000'000;
  gap.extra_gyro_noise_density = 0.03;
  gap.extra_accel_noise_density = 0.4;
  imu::ImuNoise noise;
  noise.gyro_noise_density = 0.04;
  noise.accel_noise_density = 0.3;
  Preintegrator integrator(noise, {}, 0);
  integrator.add(gap);
  const state::NodeMatrix P = integrator.result().covariance;
  EXPECT_NEAR(state::part(P, attitude, attitude)(0, 0), 0.05 * 0.05 * 0.5, 1e-15);
  EXPECT_NEAR(state::part(P, velocity, velocity)(0, 0), 0.5 * 0.5 * 0.5, 1e-15);
}

TEST(Preintegrator, RefusesHolesAndEmptyIncrements) {
  Preintegrator integrator({}, {}, 100);
  ImuIncrement hole;
  hole.t_begin_ns = 200;
  hole.t_end_ns = 300;
  EXPECT_THROW(integrator.add(hole), std::invalid_argument);
  ImuIncrement empty;
  empty.t_begin_ns = empty.t_end_ns = 100;
  EXPECT_THROW(integrator.add(empty), std::invalid_argument);
}

}  // namespace
}  // namespace foucault::preintegration
