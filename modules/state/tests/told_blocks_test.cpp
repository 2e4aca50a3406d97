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

TEST(ToldBlocks, WholeAndAlongTheVehicle) {
  std::mt19937 rng{42};
  const Told by = told();
  Epoch epoch{foucault::testing::random_state(rng, by.layout.slow_size()),
              foucault::testing::random_covariance(rng, by.layout.size())};
  epoch.slow << 0.05, 0.1, 0.2, 0.3, 0.01, 0.02, 4, 5, 6;
  const Epoch whole = as_users_know(epoch, by);
  SlowVector expected(9);
  expected << 0.25, -2.2, 1.1, 3.3, 0.01, 0.02, -5, 4, 6;
  EXPECT_LT((whole.slow - expected).norm(), 1e-14);

  const SlowBlock& arm = *by.layout.find(block::lever_arm);
  const SlowBlock& point = *by.layout.find(block::wheel_lever_arm);
  EXPECT_NEAR(part(whole.covariance, arm, arm)(0, 0), part(epoch.covariance, arm, arm)(1, 1),
              1e-14);
  EXPECT_NEAR(part(whole.covariance, arm, point)(0, 1), -part(epoch.covariance, arm, point)(1, 0),
              1e-14);
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
