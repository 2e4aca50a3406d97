#include "foucault/state/mounting_turn.h"

#include <gtest/gtest.h>

#include "foucault/core/so3.h"

namespace foucault::state {
namespace {

Layout layout() { return Layout().add(block::lever_arm, 1).add(block::mounting, 0.2); }

MountingTurn turn(double pitch, double heading) {
  SlowVector slow = SlowVector::Zero(5);
  slow.tail<2>() << pitch, heading;
  const Layout by = layout();
  return {slow, by.find(block::mounting)};
}

TEST(MountingTurn, IsPitchAndHeadingOfAnImuThatDoesNotRoll) {
  const so3::Euler euler = so3::to_euler(Eigen::Quaterniond(turn(0.3, -2.5).matrix()));
  EXPECT_NEAR(euler.roll, 0, 1e-15);
  EXPECT_NEAR(euler.pitch, 0.3, 1e-15);
  EXPECT_NEAR(so3::wrap(euler.heading), -2.5, 1e-15);
  EXPECT_EQ(MountingTurn(SlowVector::Zero(3), nullptr).matrix(), Eigen::Matrix3d::Identity());
}

TEST(MountingTurn, GradientAndAxesAgainstDifferences) {
  constexpr double kPitch = 0.3, kHeading = -2.5, kStep = 1e-6;
  const Eigen::Vector3d w(3, -1, 2);
  const MountingTurn at = turn(kPitch, kHeading);
  Eigen::Matrix<double, 3, 2> gradient, axes;
  for (int i = 0; i < 2; ++i) {
    const double pitch = i == 0 ? kStep : 0, heading = i == 1 ? kStep : 0;
    const Eigen::Matrix3d plus = turn(kPitch + pitch, kHeading + heading).matrix();
    const Eigen::Matrix3d minus = turn(kPitch - pitch, kHeading - heading).matrix();
    gradient.col(i) = (plus - minus) * w / (2 * kStep);
    axes.col(i) = so3::log(Eigen::Quaterniond(plus * minus.transpose())) / (2 * kStep);
  }
  EXPECT_LT((at.gradient(w) - gradient).norm(), 1e-8);
  EXPECT_LT((at.axes_v() - axes).norm(), 1e-8);
}

}  // namespace
}  // namespace foucault::state
