#include "foucault/state/told_blocks.h"

#include <gtest/gtest.h>

#include "random_state.h"

namespace foucault::state {
namespace {

Told told() {
  Told told;
  told.layout.add(block::time_offset, 0.3).add(block::lever_arm, 0.05);
  told.layout.add(block::mounting, 0.2).add(block::wheel_lever_arm, 1.5);
  told.time_offset_s = 0.2;
  told.lever_arm_b = {1, 2, 3};
  told.q_v_b = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ());  // forward is b's -y
  return told;
}

Told with_mounting_told(Told by) {
  Layout layout;
  for (const SlowBlock& slow : by.layout.slow()) {
    if (slow.block.name != block::mounting.name) layout.add(slow.block, slow.sigma);
  }
  by.layout = layout;
  return by;
}

TEST(ToldBlocks, WholeAndAlongTheVehicle) {
  std::mt19937 rng{42};
  const Told by = with_mounting_told(told());
  Epoch epoch{foucault::testing::random_state(rng, by.layout.slow_size()),
              foucault::testing::random_covariance(rng, by.layout.size())};
  epoch.slow << 0.05, 0.1, 0.2, 0.3, 4, 5, 6;
  const Epoch whole = as_users_know(epoch, by);
  SlowVector expected(7);
  expected << 0.25, -2.2, 1.1, 3.3, -5, 4, 6;
  EXPECT_LT((whole.slow - expected).norm(), 1e-14);

  const SlowBlock& arm = *by.layout.find(block::lever_arm);
  const SlowBlock& point = *by.layout.find(block::wheel_lever_arm);
  EXPECT_NEAR(part(whole.covariance, arm, arm)(0, 0), part(epoch.covariance, arm, arm)(1, 1),
              1e-14);
  EXPECT_NEAR(part(whole.covariance, arm, point)(0, 1), -part(epoch.covariance, arm, point)(1, 0),
              1e-14);
  EXPECT_EQ(node_part(whole.covariance), node_part(epoch.covariance));
}

/// An arm along the vehicle stays what it is, whichever way the IMU is turned in it.
TEST(ToldBlocks, AlongTheVehicleAsItsMountingWasFound) {
  const Told by = told();
  const Eigen::Vector3d arm_v(0.5, -0.3, -0.8), point_v(-1.2, 0.1, 0.4);
  const Eigen::Vector2d turn(0.12, -0.09);
  const Eigen::Quaterniond M = Eigen::AngleAxisd(turn[1], Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(turn[0], Eigen::Vector3d::UnitY());
  const Eigen::Quaterniond q_b_v = (M * by.q_v_b).conjugate();
  Epoch epoch = with_slow_blocks({}, by.layout);
  epoch.slow << 0, q_b_v * arm_v - by.lever_arm_b, turn, q_b_v * point_v;
  const Epoch whole = as_users_know(epoch, by);
  EXPECT_LT((whole.slow.segment<3>(1) - arm_v).norm(), 1e-14);
  EXPECT_LT((whole.slow.tail<3>() - point_v).norm(), 1e-14);
}

TEST(ToldBlocks, CovarianceFollowsTheMountingToo) {
  std::mt19937 rng{7};
  const Told by = told();
  Epoch epoch{foucault::testing::random_state(rng, by.layout.slow_size()),
              foucault::testing::random_covariance(rng, by.layout.size())};
  epoch.slow << 0.05, 0.1, 0.2, 0.3, 0.1, -0.2, 4, 5, 6;
  const int size = by.layout.slow_size();
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(size, size);
  for (int column = 0; column < size; ++column) {
    Epoch plus = epoch, minus = epoch;
    plus.slow[column] += kStep;
    minus.slow[column] -= kStep;
    J.col(column) = (as_users_know(plus, by).slow - as_users_know(minus, by).slow) / (2 * kStep);
  }
  const Eigen::MatrixXd expected = J * slow_part(epoch.covariance) * J.transpose();
  const Epoch whole = as_users_know(epoch, by);
  EXPECT_LT((slow_part(whole.covariance) - expected).norm(), 1e-8 * expected.norm());
  EXPECT_EQ(node_part(whole.covariance), node_part(epoch.covariance));
}

TEST(ToldBlocks, ThePriorIsAboutWhatWasTold) {
  const Told by = told();
  const Epoch prior = prior_as_users_know(by);
  EXPECT_EQ(prior.slow[0], 0.2);
  EXPECT_NEAR(prior.slow[1], -2, 1e-15);
  EXPECT_NEAR((slow_part(prior.covariance) - by.layout.prior()).norm(), 0, 1e-14);
}

}  // namespace
}  // namespace foucault::state
