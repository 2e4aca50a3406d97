#include "foucault/preintegration/preintegrator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "closed_form_motion.h"
#include "dense_preintegrator.h"
#include "foucault/inertial/increments.h"

namespace foucault {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ClosedFormMotion;
using testing::DensePreintegrator;
using testing::preintegrate;
using testing::wuhan_earth;
using namespace error_state;

/// Noise with every part of comparable effect over a second, so that no block hides.
ImuNoise loud_noise() {
  ImuNoise noise;
  noise.gyro_noise_density = 2e-3;
  noise.accel_noise_density = 3e-2;
  noise.gyro_bias_sigma = 4e-3;
  noise.accel_bias_sigma = 5e-2;
  noise.bias_tau = 2;
  return noise;
}

/// |A - B| with every entry in units of B's own sigmas.
double normalized_difference(const Matrix15d& A, const Matrix15d& B) {
  const Vector15d s = B.diagonal().cwiseSqrt().cwiseInverse();
  return (s.asDiagonal() * (A - B) * s.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(Preintegrator, StructuredFormEqualsDenseProducts) {
  const ClosedFormMotion motion(wuhan_earth());
  const std::vector<ImuIncrement> increments = motion.increments(3, 4, 200);
  const ImuBias bias{{0.01, -0.02, 0.015}, {0.1, 0.05, -0.2}};
  DensePreintegrator products(loud_noise(), bias, increments.front());
  for (std::size_t i = 1; i < increments.size(); ++i) products.add(increments[i]);
  const Preintegration dense = products.result();
  const Preintegration structured = preintegrate(increments, loud_noise(), bias);
  // Same arithmetic in another order: rounding only. Everything is below 10 in its unit.
  EXPECT_LT(normalized_difference(structured.covariance, dense.covariance), 1e-12);
  const auto near = [](const auto& a, const auto& b) {
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-12);
  };
  near(structured.J_dp_bg, dense.J_dp_bg);
  near(structured.J_dp_ba, dense.J_dp_ba);
  near(structured.J_dv_bg, dense.J_dv_bg);
  near(structured.J_dv_ba, dense.J_dv_ba);
  near(structured.J_dq_bg, dense.J_dq_bg);
  near(structured.dp, dense.dp);
  near(structured.dv, dense.dv);
  near(structured.dq.coeffs(), dense.dq.coeffs());
}

TEST(Preintegrator, CovarianceApproachesVanLoan) {
  const ClosedFormMotion motion(wuhan_earth());
  const ImuNoise noise = loud_noise();
  // Van Loan on a fine grid, rates constant within 1 ms.
  Matrix15d exact = Matrix15d::Zero();
  for (int k = 0; k < 1000; ++k) {
    const double t = 3 + (k + 0.5) * 1e-3;
    Matrix15d F = Matrix15d::Zero();
    const Matrix3d C = (motion.q(3).conjugate() * motion.q(t)).toRotationMatrix();
    F.block<3, 3>(kPosition, kVelocity).setIdentity();
    F.block<3, 3>(kVelocity, kAttitude) = -C * so3::skew(motion.specific_force_b(t));
    F.block<3, 3>(kVelocity, kAccelBias) = -C;
    F.block<3, 3>(kAttitude, kAttitude) = -so3::skew(motion.omega_ib_b(t));
    F.block<3, 3>(kAttitude, kGyroBias) = -Matrix3d::Identity();
    F.block<6, 6>(kGyroBias, kGyroBias) = -Eigen::Matrix<double, 6, 6>::Identity() / noise.bias_tau;
    Vector15d W = Vector15d::Zero();
    W.segment<3>(kVelocity).setConstant(std::pow(noise.accel_noise_density, 2));
    W.segment<3>(kAttitude).setConstant(std::pow(noise.gyro_noise_density, 2));
    W.segment<3>(kGyroBias).setConstant(noise.gyro_bias_power());
    W.segment<3>(kAccelBias).setConstant(noise.accel_bias_power());
    Eigen::Matrix<double, 30, 30> M = Eigen::Matrix<double, 30, 30>::Zero();
    M.block<15, 15>(0, 0) = -F;
    M.block<15, 15>(0, 15) = W.asDiagonal();
    M.block<15, 15>(15, 15) = F.transpose();
    const Eigen::Matrix<double, 30, 30> E = (M * 1e-3).exp();
    const Matrix15d phi = E.block<15, 15>(15, 15).transpose();
    exact = phi * exact * phi.transpose() + phi * E.block<15, 15>(0, 15);
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
  const ImuNoise noise = loud_noise();
  const std::vector<ImuIncrement> clean = motion.increments(3, 4, 100);
  const Preintegration truth = preintegrate(clean, noise);
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Vector3d(normal(rng), normal(rng), normal(rng)); };

  constexpr int kRuns = 4000;
  Matrix15d sample = Matrix15d::Zero();
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
    Vector15d error;  // true minus measured
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
  const Matrix15d P = preintegrate(motion.increments(3, 3.005, 200), loud_noise()).covariance;
  EXPECT_EQ(Eigen::LLT<Matrix15d>(P).info(), Eigen::Success);
  // White noise over one interval: dt^3/2 by the trapezoid, dt^3/3 exactly.
  EXPECT_NEAR(P(kPosition, kPosition), 9e-4 * std::pow(0.005, 3) / 2, 1e-12);
}

TEST(Preintegrator, BiasJacobiansAreDerivatives) {
  const ClosedFormMotion motion(wuhan_earth());
  const std::vector<ImuIncrement> increments = motion.increments(3, 4, 200);
  const ImuBias at{{0.01, -0.02, 0.015}, {0.1, 0.05, -0.2}};
  const Preintegration pre = preintegrate(increments, {}, at);
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d d = kStep * Vector3d::Unit(axis);
    const Preintegration g1 = preintegrate(increments, {}, {at.gyro + d, at.accel});
    const Preintegration g0 = preintegrate(increments, {}, {at.gyro - d, at.accel});
    const Preintegration a1 = preintegrate(increments, {}, {at.gyro, at.accel + d});
    const Preintegration a0 = preintegrate(increments, {}, {at.gyro, at.accel - d});
    // The step's derivative leaves out how the bias enters the 1/12 coning and sculling terms:
    // relative (change of the rate from sample to sample) / 12, here below 1e-5.
    const auto near = [](const Vector3d& difference, const Vector3d& column, double scale) {
      EXPECT_LT((difference / (2 * kStep) - column).norm(), 2e-5 * scale);
    };
    near(g1.dp - g0.dp, pre.J_dp_bg.col(axis), 2);
    near(g1.dv - g0.dv, pre.J_dv_bg.col(axis), 5);
    near(so3::log(g0.dq.conjugate() * g1.dq), pre.J_dq_bg.col(axis), 1);
    near(a1.dp - a0.dp, pre.J_dp_ba.col(axis), 0.5);
    near(a1.dv - a0.dv, pre.J_dv_ba.col(axis), 1);
  }
}

TEST(Preintegrator, SplittingAnIncrementChangesLittle) {
  const ClosedFormMotion motion(wuhan_earth());
  std::vector<ImuIncrement> increments = motion.increments(3, 4, 200);
  const Preintegration whole = preintegrate(increments);
  const std::pair<ImuIncrement, ImuIncrement> parts =
      split(increments[77], increments[77].t_begin_ns + 1'234'567);
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
  ImuNoise noise;
  noise.gyro_noise_density = 0.04;
  noise.accel_noise_density = 0.3;
  Preintegrator integrator(noise, {}, 0);
  integrator.add(gap);
  const Matrix15d P = integrator.result().covariance;
  EXPECT_NEAR(P(kAttitude, kAttitude), 0.05 * 0.05 * 0.5, 1e-15);
  EXPECT_NEAR(P(kVelocity, kVelocity), 0.5 * 0.5 * 0.5, 1e-15);
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
}  // namespace foucault
