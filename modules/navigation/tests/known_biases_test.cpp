#include "../src/known_biases.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "foucault/core/so3.h"
#include "foucault/state/layout.h"

namespace foucault::navigation {
namespace {

using namespace state::block;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGyroSigma = 1e-4;   ///< of an earlier bias [rad/s]
constexpr double kAccelSigma = 1e-3;  ///< [m/s^2]
constexpr double kScaleSigma = 2e-4;

state::StateVector draw(std::mt19937& rng, Eigen::Index size) {
  std::normal_distribution<double> normal;
  return state::StateVector::NullaryExpr(size, [&] { return normal(rng); });
}

/// An alignment whose errors are correlated, biases 100 times less known than before.
state::Epoch random_alignment(unsigned seed) {
  std::mt19937 rng{seed};
  state::NodeVector sigmas;
  state::part(sigmas, position).setConstant(0.1);
  state::part(sigmas, velocity).setConstant(0.05);
  state::part(sigmas, attitude).setConstant(0.01);
  state::part(sigmas, gyro_bias).setConstant(100 * kGyroSigma);
  state::part(sigmas, accel_bias).setConstant(100 * kAccelSigma);
  state::NodeMatrix root;
  for (Eigen::Index i = 0; i < root.cols(); ++i) root.col(i) = draw(rng, root.rows());
  const state::NodeMatrix shape =
      root * root.transpose() / 15 + 0.1 * state::NodeMatrix::Identity();

  state::Epoch aligned;
  aligned.t_ns = 5'000'000'000;
  aligned.position = {0.6, 2, 30};
  aligned.velocity_n = Vector3d(3, 4, 0);
  aligned.q_n_b = so3::exp({0.1, -0.2, 2});
  aligned.bias = {Vector3d(1e-3, 2e-3, -1e-3), Vector3d(0.02, -0.01, 0.03)};
  aligned.covariance = sigmas.asDiagonal() * shape * sigmas.asDiagonal();
  return aligned;
}

/// Somewhere else, long ago.
state::Epoch earlier_epoch(Eigen::Index slow_size) {
  state::Epoch earlier;
  earlier.position = {0.61, 2.01, 300};
  earlier.velocity_n = Vector3d(-30, 4, 1);
  earlier.q_n_b = so3::exp({0.3, 0.2, -1});
  earlier.bias = {Vector3d(-2e-3, 1e-3, 3e-3), Vector3d(-0.02, 0.04, 0.01)};
  earlier.slow = state::SlowVector::LinSpaced(slow_size, -1e-3, 2e-3);
  state::StateVector variance = state::StateVector::Ones(state::state_size(slow_size));
  state::part(variance, gyro_bias).setConstant(kGyroSigma * kGyroSigma);
  state::part(variance, accel_bias).setConstant(kAccelSigma * kAccelSigma);
  state::slow_part(variance).setConstant(kScaleSigma * kScaleSigma);
  earlier.covariance = variance.asDiagonal();
  return earlier;
}

/// Two independent sources, biases of the earlier one with doubled sigmas.
TEST(KnownBiases, WithoutSlowBlocksEqualTheInformationForm) {
  const state::Epoch aligned = random_alignment(1);
  const state::Epoch earlier = earlier_epoch(0);
  state::NodeVector information = state::NodeVector::Zero();
  state::part(information, gyro_bias).setConstant(1 / (4 * kGyroSigma * kGyroSigma));
  state::part(information, accel_bias).setConstant(1 / (4 * kAccelSigma * kAccelSigma));
  state::NodeVector measured = state::NodeVector::Zero();
  state::part(measured, gyro_bias) = earlier.bias.gyro - aligned.bias.gyro;
  state::part(measured, accel_bias) = earlier.bias.accel - aligned.bias.accel;

  // Scaled by the sigmas, or the inverse loses digits.
  const state::NodeVector unit = aligned.covariance.diagonal().cwiseSqrt();
  const state::NodeVector per_unit = unit.cwiseInverse();
  const state::NodeMatrix before =
      (per_unit.asDiagonal() * state::node_part(aligned.covariance) * per_unit.asDiagonal())
          .inverse();
  state::NodeMatrix sum = before;
  sum.diagonal() += information.cwiseProduct(unit).cwiseProduct(unit);
  const state::NodeMatrix P = unit.asDiagonal() * sum.inverse() * unit.asDiagonal();
  const state::NodeVector expected = P * information.cwiseProduct(measured);

  const state::Epoch out = with_known_biases(aligned, earlier);
  ASSERT_EQ(out.covariance.rows(), aligned.covariance.rows());
  const state::NodeVector moved = state::boxminus(out, aligned);
  // Of conditions below 1e6; a position is rounded to nanometres.
  EXPECT_LT((moved - expected).cwiseQuotient(unit).tail<12>().norm(), 1e-9);
  EXPECT_LT(state::part(moved - expected, position).norm(), 1e-8);

  state::NodeMatrix T = state::NodeMatrix::Identity();  // see kalman_update
  state::part(T, attitude, attitude) = so3::right_jacobian(state::part(expected, attitude));
  const state::NodeMatrix difference = state::node_part(out.covariance) - T * P * T.transpose();
  EXPECT_LT((per_unit.asDiagonal() * difference * per_unit.asDiagonal()).norm(), 1e-9);
}

TEST(KnownBiases, TellAttitudeAndVelocityToo) {
  const state::Epoch aligned = random_alignment(2);
  const state::Epoch out = with_known_biases(aligned, earlier_epoch(0));
  EXPECT_EQ(out.t_ns, aligned.t_ns);
  EXPECT_GT(out.q_n_b.angularDistance(aligned.q_n_b), 1e-4);
  EXPECT_GT((out.velocity_n - aligned.velocity_n).norm(), 1e-4);
  for (const state::NodeBlock& b : {position, velocity, attitude})
    EXPECT_LT(out.sigma_of(b).norm(), aligned.sigma_of(b).norm()) << b.name;
  // Much better known than by the alignment, so they are as they were, at twice their sigma.
  EXPECT_LT((out.bias.gyro - earlier_epoch(0).bias.gyro).norm(), 0.2 * kGyroSigma);
  EXPECT_NEAR(out.sigma_of(gyro_bias).x() / kGyroSigma, 2, 0.01);
  EXPECT_NEAR(out.sigma_of(accel_bias).y() / kAccelSigma, 2, 0.01);
}

/// What the earlier state knew of the two together.
TEST(KnownBiases, CorrelationWithScaleFactorsSurvives) {
  const state::Epoch aligned = random_alignment(3);
  state::Epoch earlier = earlier_epoch(3);
  constexpr double kCorrelation = -0.9;
  state::Layout layout;
  layout.add(gyro_scale, kScaleSigma);
  const Matrix3d together = kCorrelation * kGyroSigma * kScaleSigma * Matrix3d::Identity();
  state::columns_of(state::rows_of(earlier.covariance, gyro_bias), *layout.find(gyro_scale)) =
      together;
  state::columns_of(earlier.covariance, gyro_bias).bottomRows<3>() = together;

  const state::Epoch out = with_known_biases(aligned, earlier);
  ASSERT_EQ(out.covariance.rows(), layout.size());
  const Matrix3d crossed =
      state::columns_of(state::rows_of(out.covariance, gyro_bias), *layout.find(gyro_scale));
  const Vector3d scale_sigma = state::slow_part(out.covariance.diagonal()).cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis) {
    const double correlation =
        crossed(axis, axis) / (out.sigma_of(gyro_bias)[axis] * scale_sigma[axis]);
    // What else is known of the bias has 1/50 of its sigma: 4e-4 of variances.
    EXPECT_NEAR(correlation, kCorrelation, 2e-3) << axis;
  }
  EXPECT_EQ(out.covariance, out.covariance.transpose());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(out.covariance).info(), Eigen::Success);
}

/// If the alignment shows another bias, the scale factor goes with it.
TEST(KnownBiases, CorrelatedScaleFollowsTheBias) {
  state::Epoch aligned = random_alignment(4);
  aligned.covariance = 1e-8 * state::NodeMatrix::Identity();  // surer than before: sigma 1e-4 rad/s
  state::Epoch earlier = earlier_epoch(3);
  aligned.bias = earlier.bias;
  aligned.bias.gyro.z() += 2e-4;
  const int z = 2;
  const double together = 0.9 * kGyroSigma * kScaleSigma;
  const Eigen::Index scale_row = earlier.covariance.rows() - 3 + z;
  state::rows_of(earlier.covariance, gyro_bias)(z, scale_row) = together;
  state::columns_of(earlier.covariance, gyro_bias)(scale_row, z) = together;
  const state::Epoch out = with_known_biases(aligned, earlier);
  // Between both: 1e-8 here, 4e-8 there.
  const double bias_change = out.bias.gyro.z() - earlier.bias.gyro.z();
  EXPECT_NEAR(bias_change, 2e-4 * 4 / 5, 2e-7);
  // By the regression of one on the other; the prior on the scale, 1e4 variances, does not count.
  EXPECT_NEAR(out.slow[z] - earlier.slow[z], 0.9 * kScaleSigma / kGyroSigma * bias_change, 1e-6);
}

TEST(KnownBiases, LearnedSlowBlockKeepsItsValueAtTwiceItsSigma) {
  const state::Epoch aligned = random_alignment(5);
  const state::Epoch earlier = earlier_epoch(6);
  const state::Epoch out = with_known_biases(aligned, earlier);
  EXPECT_LT((out.slow - earlier.slow).norm(), 1e-3 * kScaleSigma);
  for (const double variance : state::slow_part(out.covariance.diagonal())) {
    EXPECT_GT(std::sqrt(variance), 1.99 * kScaleSigma);
    EXPECT_LE(std::sqrt(variance), 2 * kScaleSigma);
  }
}

/// Ten holes, and nothing learned between them: start() of a navigator keeps to the prior.
TEST(KnownBiases, SigmasStayWithinThePriorOverManyRestarts) {
  const state::Epoch aligned = random_alignment(6);
  state::Layout layout;
  layout.add(gyro_scale, 5 * kScaleSigma).add(accel_scale, 3 * kScaleSigma);
  state::Epoch now = earlier_epoch(6);
  for (int i = 0; i < 10; ++i)
    now = state::with_slow_blocks(with_known_biases(aligned, now), layout);
  const state::StateVector sigmas = now.covariance.diagonal().cwiseSqrt();
  EXPECT_NEAR(state::part(sigmas, *layout.find(gyro_scale)).maxCoeff(), 5 * kScaleSigma, 1e-12);
  EXPECT_NEAR(state::part(sigmas, *layout.find(accel_scale)).maxCoeff(), 3 * kScaleSigma, 1e-12);
  EXPECT_LE(now.sigma_of(gyro_bias).maxCoeff(), aligned.sigma_of(gyro_bias).maxCoeff());
}

}  // namespace
}  // namespace foucault::navigation
