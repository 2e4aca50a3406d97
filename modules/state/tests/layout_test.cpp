#include "foucault/state/layout.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <stdexcept>

namespace foucault::state {
namespace {

constexpr Block kTwo{"two", 2, "m"};
constexpr Block kFive{"five", 5, "K"};

Layout scale_between_others() {
  Layout layout;
  layout.add(kTwo, 0.5)
      .add(block::accel_scale, 2e-3, 3600)
      .add(kFive, 3)
      .add(block::gyro_scale, 1e-3);
  return layout;
}

TEST(Layout, BlocksOfANodeFollowOneAnother) {
  int next = 0;
  for (const NodeBlock& b :
       {block::position, block::velocity, block::attitude, block::gyro_bias, block::accel_bias}) {
    EXPECT_EQ(b.offset, next) << b.name;
    next += b.size;
  }
  EXPECT_EQ(next, kNodeSize);
  EXPECT_EQ(kMotionSize, block::gyro_bias.offset);
}

TEST(Layout, WithoutSlowBlocksIsThatOfANode) {
  const Layout layout;
  EXPECT_EQ(layout.size(), kNodeSize);
  EXPECT_EQ(layout.slow_size(), 0);
  EXPECT_EQ(layout.prior().size(), 0);
  EXPECT_EQ(layout.find(block::gyro_scale), nullptr);
  EXPECT_FALSE(layout.slow_index(block::gyro_scale));
}

TEST(Layout, SlowBlocksStandInTheOrderInWhichTheyCame) {
  const Layout layout = scale_between_others();
  EXPECT_EQ(layout.slow_size(), 2 + 3 + 5 + 3);
  EXPECT_EQ(layout.size(), kNodeSize + layout.slow_size());
  EXPECT_EQ(layout.slow_index(kTwo), 0);
  EXPECT_EQ(layout.slow_index(block::accel_scale), 2);
  EXPECT_EQ(layout.slow_index(kFive), 5);
  EXPECT_EQ(layout.slow_index(block::gyro_scale), 10);
  ASSERT_EQ(layout.slow().size(), 4u);
  for (const SlowBlock& slow : layout.slow()) {
    EXPECT_EQ(layout.find(slow.block), &slow) << slow.block.name;
    EXPECT_EQ(layout.slow_index(slow.block), slow.index) << slow.block.name;
  }
}

TEST(Layout, KeepsSigmaAndTime) {
  const Layout layout = scale_between_others();
  EXPECT_EQ(layout.find(block::accel_scale)->sigma, 2e-3);
  EXPECT_EQ(layout.find(block::accel_scale)->tau, 3600);
  EXPECT_EQ(layout.find(kFive)->tau, std::numeric_limits<double>::infinity());
}

TEST(Layout, PriorHasTheSquaredSigmaOfEachRow) {
  const Layout layout = scale_between_others();
  SlowVector variance(13);
  variance << 0.25, 0.25, 4e-6, 4e-6, 4e-6, 9, 9, 9, 9, 9, 1e-6, 1e-6, 1e-6;
  const SlowMatrix expected = variance.asDiagonal();
  ASSERT_EQ(layout.prior().rows(), 13);
  EXPECT_LT((layout.prior() - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Layout, RefusesASecondBlockOfOneName) {
  Layout layout = scale_between_others();
  const Block other_size{"two", 1, "s"};
  EXPECT_THROW(layout.add(other_size, 1), std::invalid_argument);
  EXPECT_EQ(layout.slow().size(), 4u);
  EXPECT_EQ(layout.slow_size(), 13);
}

TEST(Layout, RefusesABlockForWhichThereIsNoRoom) {
  Layout layout;
  const Block rest{"rest", kMostSlow - 5, "1"};
  layout.add(kFive, 1).add(rest, 1);  // full to the last row
  EXPECT_EQ(layout.slow_size(), kMostSlow);
  EXPECT_EQ(layout.size(), kMostSize);
  const Block one{"one", 1, "1"};
  EXPECT_THROW(layout.add(one, 1), std::invalid_argument);
  EXPECT_EQ(layout.slow_size(), kMostSlow);
  EXPECT_EQ(layout.find(one), nullptr);
}

TEST(Layout, ScaleOfTheImuIsFoundWhereverItStands) {
  const Layout layout = scale_between_others();
  const SlowVector slow = SlowVector::LinSpaced(layout.slow_size(), 0, 12);
  const ImuScale scale = layout.imu_scale(slow);
  EXPECT_EQ(scale.accel, Eigen::Vector3d(2, 3, 4));
  EXPECT_EQ(scale.gyro, Eigen::Vector3d(10, 11, 12));
}

TEST(Layout, ScaleOfTheImuIsZeroIfItIsNotEstimated) {
  Layout layout;
  layout.add(kFive, 1).add(block::gyro_scale, 1);
  const ImuScale scale = layout.imu_scale(SlowVector::Ones(8));
  EXPECT_EQ(scale.gyro, Eigen::Vector3d::Ones());
  EXPECT_EQ(scale.accel, Eigen::Vector3d::Zero());
}

/// Each of the parts writes to rows of its own, and together they fill the whole.
TEST(Layout, PartsCoverAState) {
  const Layout layout = scale_between_others();
  StateVector v = StateVector::Zero(layout.size());
  for (const NodeBlock& b :
       {block::position, block::velocity, block::attitude, block::gyro_bias, block::accel_bias})
    part(v, b).array() += 1;
  EXPECT_EQ(v.sum(), kNodeSize);
  EXPECT_EQ(node_part(v), NodeVector::Ones());
  for (const SlowBlock& slow : layout.slow()) part(v, slow).array() += 1;
  EXPECT_EQ(v, StateVector::Ones(layout.size()));
  EXPECT_EQ(slow_part(v).size(), layout.slow_size());
  EXPECT_EQ(sensor_part(v).size(), 6 + layout.slow_size());
}

TEST(Layout, PartsCoverAMatrix) {
  const Layout layout = scale_between_others();
  StateMatrix m = StateMatrix::Zero(layout.size(), layout.size());
  node_part(m).array() += 1;
  slow_part(m).array() += 2;
  node_by_slow(m).array() += 3;
  slow_by_node(m).array() += 4;
  EXPECT_EQ((m.array() == 0).count(), 0);
  EXPECT_EQ(m(kNodeSize - 1, kNodeSize - 1), 1);
  EXPECT_EQ(m(kNodeSize, kNodeSize), 2);
  EXPECT_EQ(m(kNodeSize - 1, kNodeSize), 3);
  EXPECT_EQ(m(kNodeSize, kNodeSize - 1), 4);

  const SlowBlock& accel = *layout.find(block::accel_scale);
  m.setZero();
  columns_of(m, accel).setOnes();
  EXPECT_EQ(m.sum(), 3 * layout.size());
  EXPECT_EQ(m(0, kNodeSize + 2), 1);
  part(m, *layout.find(kTwo), accel).setConstant(7);
  EXPECT_EQ((m.array() == 7).count(), 6);
  EXPECT_EQ(m(kNodeSize + 1, kNodeSize + 4), 7);
}

}  // namespace
}  // namespace foucault::state
