#include "foucault/state/vehicle_attitude.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "foucault/core/constants.h"

namespace foucault::state {
namespace {

TEST(VehicleAttitude, TurnsTheMountingOut) {
  // An IMU that looks backward, right, up (as RTK car recordings have it) in a vehicle going east.
  Mounting mounting;
  mounting.q_v_b = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitY());
  const Eigen::Quaterniond q_n_v = so3::from_euler({0.01, -0.02, kPi / 2});
  Epoch epoch;
  epoch.q_n_b = q_n_v * mounting.q_v_b;
  const VehicleAttitude attitude = vehicle_attitude(epoch, mounting);
  EXPECT_NEAR(attitude.euler.roll, 0.01, 1e-15);
  EXPECT_NEAR(attitude.euler.pitch, -0.02, 1e-15);
  EXPECT_NEAR(attitude.euler.heading, kPi / 2, 1e-15);
}

TEST(VehicleAttitude, SigmaFollowsTheMounting) {
  Mounting mounting;  // b's x axis points right, its y axis backward
  mounting.q_v_b = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ());
  Epoch epoch;
  epoch.q_n_b = mounting.q_v_b;  // level, north
  part(epoch.covariance.diagonal(), block::attitude) << 1e-4, 4e-4, 9e-4;
  const VehicleAttitude attitude = vehicle_attitude(epoch, mounting);
  EXPECT_NEAR(attitude.sigma[0], 0.02, 1e-15);  // roll: about b's y
  EXPECT_NEAR(attitude.sigma[1], 0.01, 1e-15);
  EXPECT_NEAR(attitude.sigma[2], 0.03, 1e-15);
}

/// Where the mounting is estimated, too, with what the two have in common.
TEST(VehicleAttitude, CovarianceIsByThePerturbationsOfAttitudeAndMounting) {
  Layout layout;
  layout.add(block::lever_arm, 1).add(block::mounting, 0.2);
  const Mounting mounting = Mounting{so3::exp({0.3, -1.1, 2.0})}.with(layout);
  Epoch epoch;
  epoch.q_n_b = so3::from_euler({0.3, 0.9, 2.5}) * mounting.q_v_b;
  epoch.slow = SlowVector::Zero(layout.slow_size());
  epoch.slow.segment<2>(layout.find(block::mounting)->index) << 0.05, -0.2;
  std::mt19937 rng{7};
  std::normal_distribution<double> normal;
  const StateMatrix root =
      1e-3 * StateMatrix::NullaryExpr(layout.size(), layout.size(), [&] { return normal(rng); });
  epoch.covariance = root * root.transpose();
  const VehicleAttitude mean = vehicle_attitude(epoch, mounting);
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  for (int i = 0; i < layout.size(); ++i) {
    Epoch moved = epoch;
    static_cast<NavState&>(moved) = boxplus(epoch, 1e-3 * root.col(i));
    const Eigen::Vector3d turned =
        1e3 * so3::log(mean.q_n_v.conjugate() * vehicle_attitude(moved, mounting).q_n_v);
    expected += turned * turned.transpose();
  }
  EXPECT_LT((mean.covariance_v - expected).norm(), 1e-4 * expected.norm());
}

TEST(VehicleAttitude, SigmaIsThatOfSampledAttitudes) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  Mounting mounting;
  mounting.q_v_b = so3::exp({0.3, -1.1, 2.0});
  Epoch epoch;
  epoch.q_n_b = so3::from_euler({0.3, 0.9, 2.5}) * mounting.q_v_b;
  Eigen::Matrix3d root;
  root << 2e-3, 0, 0, 1e-3, 3e-3, 0, -1e-3, 5e-4, 1e-3;
  part(epoch.covariance, block::attitude, block::attitude) = root * root.transpose();
  const VehicleAttitude mean = vehicle_attitude(epoch, mounting);

  constexpr int kSamples = 20'000;
  Eigen::Vector3d sum_of_squares = Eigen::Vector3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Epoch sample = epoch;
    sample.q_n_b =
        epoch.q_n_b * so3::exp(root * Eigen::Vector3d(normal(rng), normal(rng), normal(rng)));
    const so3::Euler e = vehicle_attitude(sample, mounting).euler;
    const Eigen::Vector3d error(so3::wrap(e.roll - mean.euler.roll), e.pitch - mean.euler.pitch,
                                so3::wrap(e.heading - mean.euler.heading));
    sum_of_squares += error.cwiseAbs2();
  }
  const Eigen::Vector3d sampled = (sum_of_squares / kSamples).cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    // A sigma from n samples errs by 1 / sqrt(2 n) = 0.5 %; four times that.
    EXPECT_NEAR(sampled[i] / mean.sigma[i], 1, 0.02) << i;
  }
}

}  // namespace
}  // namespace foucault::state
