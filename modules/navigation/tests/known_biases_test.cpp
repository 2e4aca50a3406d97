#include "../src/known_biases.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "foucault/core/so3.h"
#include "foucault/state/layout.h"

namespace foucault::navigation {
namespace {

using namespace block;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGyroSigma = 1e-4;   ///< of an earlier bias [rad/s]
constexpr double kAccelSigma = 1e-3;  ///< [m/s^2]
constexpr double kScaleSigma = 2e-4;

StateVector draw(std::mt19937& rng, Eigen::Index size) {
  std::normal_distribution<double> normal;
  return StateVector::NullaryExpr(size, [&] { return normal(rng); });
}

/// An alignment whose errors are correlated, biases 100 times less known than before.
Epoch random_alignment(unsigned seed) {
  std::mt19937 rng{seed};
  NodeVector sigmas;
  part(sigmas, position).setConstant(0.1);
  part(sigmas, velocity).setConstant(0.05);
  part(sigmas, attitude).setConstant(0.01);
  part(sigmas, gyro_bias).setConstant(100 * kGyroSigma);
  part(sigmas, accel_bias).setConstant(100 * kAccelSigma);
  NodeMatrix root;
  for (Eigen::Index i = 0; i < root.cols(); ++i) root.col(i) = draw(rng, root.rows());
  const NodeMatrix shape = root * root.transpose() / 15 + 0.1 * NodeMatrix::Identity();

  Epoch aligned;
  aligned.t_ns = 5'000'000'000;
  aligned.position = {0.6, 2, 30};
  aligned.velocity_n = Vector3d(3, 4, 0);
  aligned.q_n_b = so3::exp({0.1, -0.2, 2});
  aligned.bias = {Vector3d(1e-3, 2e-3, -1e-3), Vector3d(0.02, -0.01, 0.03)};
  aligned.covariance = sigmas.asDiagonal() * shape * sigmas.asDiagonal();
  return aligned;
}

/// Somewhere else, long ago.
Epoch earlier_epoch(Eigen::Index slow_size) {
  Epoch earlier;
  earlier.position = {0.61, 2.01, 300};
  earlier.velocity_n = Vector3d(-30, 4, 1);
  earlier.q_n_b = so3::exp({0.3, 0.2, -1});
  earlier.bias = {Vector3d(-2e-3, 1e-3, 3e-3), Vector3d(-0.02, 0.04, 0.01)};
  earlier.slow = SlowVector::LinSpaced(slow_size, -1e-3, 2e-3);
  StateVector variance = StateVector::Ones(state_size(slow_size));
  part(variance, gyro_bias).setConstant(kGyroSigma * kGyroSigma);
  part(variance, accel_bias).setConstant(kAccelSigma * kAccelSigma);
  slow_part(variance).setConstant(kScaleSigma * kScaleSigma);
  earlier.covariance = variance.asDiagonal();
  return earlier;
}

/// Two independent sources, biases of the earlier one with doubled sigmas.
TEST(KnownBiases, WithoutSlowBlocksEqualTheInformationForm) {
  const Epoch aligned = random_alignment(1);
  const Epoch earlier = earlier_epoch(0);
  NodeVector information = NodeVector::Zero();
  part(information, gyro_bias).setConstant(1 / (4 * kGyroSigma * kGyroSigma));
  part(information, accel_bias).setConstant(1 / (4 * kAccelSigma * kAccelSigma));
  NodeVector measured = NodeVector::Zero();
  part(measured, gyro_bias) = earlier.bias.gyro - aligned.bias.gyro;
  part(measured, accel_bias) = earlier.bias.accel - aligned.bias.accel;

  // Scaled by the sigmas, or the inverse loses digits.
  const NodeVector unit = aligned.covariance.diagonal().cwiseSqrt();
  const NodeVector per_unit = unit.cwiseInverse();
  const NodeMatrix before =
      (per_unit.asDiagonal() * node_part(aligned.covariance) * per_unit.asDiagonal()).inverse();
  NodeMatrix sum = before;
  sum.diagonal() += information.cwiseProduct(unit).cwiseProduct(unit);
  const NodeMatrix P = unit.asDiagonal() * sum.inverse() * unit.asDiagonal();
  const NodeVector expected = P * information.cwiseProduct(measured);

  const Epoch out = with_known_biases(aligned, earlier);
  ASSERT_EQ(out.covariance.rows(), aligned.covariance.rows());
  const NodeVector moved = boxminus(out, aligned);
  // Of conditions below 1e6; a position is rounded to nanometres.
  EXPECT_LT((moved - expected).cwiseQuotient(unit).tail<12>().norm(), 1e-9);
  EXPECT_LT(part(moved - expected, position).norm(), 1e-8);

  NodeMatrix T = NodeMatrix::Identity();  // see kalman_update
  part(T, attitude, attitude) = so3::right_jacobian(part(expected, attitude));
  const NodeMatrix difference = node_part(out.covariance) - T * P * T.transpose();
  EXPECT_LT((per_unit.asDiagonal() * difference * per_unit.asDiagonal()).norm(), 1e-9);
}

TEST(KnownBiases, TellAttitudeAndVelocityToo) {
  const Epoch aligned = random_alignment(2);
  const Epoch out = with_known_biases(aligned, earlier_epoch(0));
  EXPECT_EQ(out.t_ns, aligned.t_ns);
  EXPECT_GT(out.q_n_b.angularDistance(aligned.q_n_b), 1e-4);
  EXPECT_GT((out.velocity_n - aligned.velocity_n).norm(), 1e-4);
  for (const NodeBlock& b : {position, velocity, attitude})
    EXPECT_LT(out.sigma_of(b).norm(), aligned.sigma_of(b).norm()) << b.name;
  // Much better known than by the alignment, so they are as they were, at twice their sigma.
  EXPECT_LT((out.bias.gyro - earlier_epoch(0).bias.gyro).norm(), 0.2 * kGyroSigma);
  EXPECT_NEAR(out.sigma_of(gyro_bias).x() / kGyroSigma, 2, 0.01);
  EXPECT_NEAR(out.sigma_of(accel_bias).y() / kAccelSigma, 2, 0.01);
}

/// What the earlier state knew of the two together.
TEST(KnownBiases, CorrelationWithScaleFactorsSurvives) {
  const Epoch aligned = random_alignment(3);
  Epoch earlier = earlier_epoch(3);
  constexpr double kCorrelation = -0.9;
  Layout layout;
  layout.add(gyro_scale, kScaleSigma);
  const Matrix3d together = kCorrelation * kGyroSigma * kScaleSigma * Matrix3d::Identity();
  columns_of(rows_of(earlier.covariance, gyro_bias), *layout.find(gyro_scale)) = together;
  columns_of(earlier.covariance, gyro_bias).bottomRows<3>() = together;

  const Epoch out = with_known_biases(aligned, earlier);
  ASSERT_EQ(out.covariance.rows(), layout.size());
  const Matrix3d crossed = columns_of(rows_of(out.covariance, gyro_bias), *layout.find(gyro_scale));
  const Vector3d scale_sigma = slow_part(out.covariance.diagonal()).cwiseSqrt();
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
  Epoch aligned = random_alignment(4);
  aligned.covariance = 1e-8 * NodeMatrix::Identity();  // surer than before: sigma 1e-4 rad/s
  Epoch earlier = earlier_epoch(3);
  aligned.bias = earlier.bias;
  aligned.bias.gyro.z() += 2e-4;
  const int z = 2;
  const double together = 0.9 * kGyroSigma * kScaleSigma;
  const Eigen::Index scale_row = earlier.covariance.rows() - 3 + z;
  rows_of(earlier.covariance, gyro_bias)(z, scale_row) = together;
  columns_of(earlier.covariance, gyro_bias)(scale_row, z) = together;
  const Epoch out = with_known_biases(aligned, earlier);
  // Between both: 1e-8 here, 4e-8 there.
  const double bias_change = out.bias.gyro.z() - earlier.bias.gyro.z();
  EXPECT_NEAR(bias_change, 2e-4 * 4 / 5, 2e-7);
  // By the regression of one on the other; the prior on the scale, 1e4 variances, does not count.
  EXPECT_NEAR(out.slow[z] - earlier.slow[z], 0.9 * kScaleSigma / kGyroSigma * bias_change, 1e-6);
}

TEST(KnownBiases, LearnedSlowBlockKeepsItsValueAtTwiceItsSigma) {
  const Epoch aligned = random_alignment(5);
  const Epoch earlier = earlier_epoch(6);
  const Epoch out = with_known_biases(aligned, earlier);
  EXPECT_LT((out.slow - earlier.slow).norm(), 1e-3 * kScaleSigma);
  for (const double variance : slow_part(out.covariance.diagonal())) {
    EXPECT_GT(std::sqrt(variance), 1.99 * kScaleSigma);
    EXPECT_LE(std::sqrt(variance), 2 * kScaleSigma);
  }
}

/// Ten holes, and nothing learned between them: start() of a navigator keeps to the prior.
TEST(KnownBiases, SigmasStayWithinThePriorOverManyRestarts) {
  const Epoch aligned = random_alignment(6);
  Layout layout;
  layout.add(gyro_scale, 5 * kScaleSigma).add(accel_scale, 3 * kScaleSigma);
  Epoch now = earlier_epoch(6);
  for (int i = 0; i < 10; ++i) now = with_slow_blocks(with_known_biases(aligned, now), layout);
  const StateVector sigmas = now.covariance.diagonal().cwiseSqrt();
  EXPECT_NEAR(part(sigmas, *layout.find(gyro_scale)).maxCoeff(), 5 * kScaleSigma, 1e-12);
  EXPECT_NEAR(part(sigmas, *layout.find(accel_scale)).maxCoeff(), 3 * kScaleSigma, 1e-12);
  EXPECT_LE(now.sigma_of(gyro_bias).maxCoeff(), aligned.sigma_of(gyro_bias).maxCoeff());
}

}  // namespace
}  // namespace foucault::navigation
