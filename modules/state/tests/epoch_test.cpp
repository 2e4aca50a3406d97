#include "foucault/state/epoch.h"

#include <gtest/gtest.h>

#include "random_state.h"

namespace foucault::state {
namespace {

using namespace testing;

constexpr Block kTwo{"two", 2, "m"};

Layout some_layout() {
  Layout layout;
  layout.add(kTwo, 0.5).add(block::gyro_scale, 1e-3);
  return layout;
}

Epoch random_epoch(unsigned seed, int slow_size) {
  std::mt19937 rng{seed};
  Epoch epoch;
  static_cast<NavState&>(epoch) = random_state(rng, slow_size);
  epoch.covariance = random_covariance(rng, state_size(slow_size));
  return epoch;
}

TEST(Epoch, StartsAsThatOfANode) {
  const Epoch epoch;
  EXPECT_EQ(epoch.covariance, StateMatrix::Zero(kNodeSize, kNodeSize));
  EXPECT_EQ(epoch.slow.size(), 0);
}

TEST(Epoch, SigmaIsTheRootOfItsBlock) {
  Epoch epoch = random_epoch(1, 5);
  epoch.covariance.diagonal().segment<3>(6) << 4, 9, 16;
  EXPECT_EQ(epoch.sigma_of(block::attitude), Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(epoch.covariance_of(block::velocity), (epoch.covariance.block<3, 3>(3, 3)));
  EXPECT_EQ(epoch.covariance_of(block::accel_bias), (epoch.covariance.block<3, 3>(12, 12)));
}

TEST(Epoch, VarianceRoundedBelowZeroHasNoSigma) {
  Epoch epoch;
  epoch.covariance(4, 4) = -1e-20;
  EXPECT_EQ(epoch.sigma_of(block::velocity), Eigen::Vector3d::Zero());
}

TEST(WithSlowBlocks, AddsThemAtTheirPrior) {
  const Layout layout = some_layout();
  const Epoch node = random_epoch(2, 0);
  const Epoch whole = with_slow_blocks(node, layout);
  EXPECT_EQ(whole.slow, SlowVector::Zero(5));
  ASSERT_EQ(whole.covariance.rows(), 20);
  ASSERT_EQ(whole.covariance.cols(), 20);
  EXPECT_EQ(node_part(whole.covariance), node.covariance);
  EXPECT_EQ(slow_part(whole.covariance), layout.prior());
  EXPECT_EQ(node_by_slow(whole.covariance).norm(), 0);
  EXPECT_EQ(slow_by_node(whole.covariance).norm(), 0);
  EXPECT_EQ(boxminus(whole, with_slow_blocks(node, layout)).norm(), 0);
  EXPECT_EQ(whole.velocity_n, node.velocity_n);
}

TEST(WithSlowBlocks, ForgetsNothingOfThoseThatAreThere) {
  Epoch learned = random_epoch(3, 5);
  learned.covariance *= 1e-8;  // surer than the prior
  const Epoch same = with_slow_blocks(learned, some_layout());
  EXPECT_EQ(same.slow, learned.slow);
  EXPECT_EQ(same.covariance, learned.covariance);
}

/// A restart doubles the sigmas of what is known; ten of them make no scale factor of 100 %.
TEST(WithSlowBlocks, NoneIsLessCertainThanItsPrior) {
  Epoch doubtful = random_epoch(6, 5);
  const StateVector sigmas = doubtful.covariance.diagonal().cwiseSqrt();
  const Epoch whole = with_slow_blocks(doubtful, some_layout());
  const StateVector left = whole.covariance.diagonal().cwiseSqrt();
  EXPECT_EQ(node_part(left), node_part(sigmas));
  EXPECT_NEAR(part(left, *some_layout().find(kTwo)).maxCoeff(), 0.5, 1e-15);
  for (const double sigma : part(left, *some_layout().find(block::gyro_scale)))
    EXPECT_NEAR(sigma, 1e-3, 1e-15);
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j)
      EXPECT_NEAR(whole.covariance(i, j) / (left[i] * left[j]),
                  doubtful.covariance(i, j) / (sigmas[i] * sigmas[j]), 1e-12);
  }
  EXPECT_EQ(whole.slow, doubtful.slow);
}

TEST(WithSlowBlocks, TakesOneThatIsKnownExactly) {
  Layout layout;
  layout.add(kTwo, 0);
  const Epoch whole = with_slow_blocks(random_epoch(7, 0), layout);
  EXPECT_EQ(with_slow_blocks(whole, layout).covariance, whole.covariance);
}

TEST(WithSlowBlocks, LeavesANodeWhereNoneIsEstimated) {
  const Epoch node = random_epoch(4, 0);
  const Epoch same = with_slow_blocks(node, Layout{});
  EXPECT_EQ(same.covariance, node.covariance);
  EXPECT_EQ(same.slow.size(), 0);
}

TEST(PackedSymmetric, ReturnsWhatItWasGiven) {
  std::mt19937 rng{5};
  for (const int size : {1, 15, 18, 32}) {
    const StateMatrix root = random_covariance(rng, size);
    const StateMatrix m = 0.5 * (root + root.transpose());
    EXPECT_EQ(PackedSymmetric(m).full(), m) << size;
  }
  EXPECT_EQ(PackedSymmetric().full().size(), 0);
}

/// What is no symmetric matrix comes back as the one of its lower triangle.
TEST(PackedSymmetric, KeepsTheLowerTriangle) {
  StateMatrix m(2, 2);
  m << 1, 99, 2, 3;
  StateMatrix expected(2, 2);
  expected << 1, 2, 2, 3;
  EXPECT_EQ(PackedSymmetric(m).full(), expected);
}

}  // namespace
}  // namespace foucault::state
