#include "foucault/state/vehicle_velocity.h"

#include <gtest/gtest.h>

#include "random_state.h"

namespace foucault::state {
namespace {

TEST(VehicleVelocity, IsForwardInAVehicleThatDoesNotSlip) {
  Told told;
  told.layout.add(block::mounting, 0.2);
  told.q_v_b = so3::exp({0.3, -1.1, 2.0});
  const so3::Euler mounting{0, 0.1, -0.2};
  const Eigen::Quaterniond q_n_v = so3::from_euler({0.02, 0.05, 2.5});
  Epoch epoch = with_slow_blocks({}, told.layout);
  epoch.slow = Eigen::Vector2d(mounting.pitch, mounting.heading);
  epoch.q_n_b = q_n_v * so3::from_euler(mounting) * told.q_v_b;
  epoch.velocity_n = q_n_v * Eigen::Vector3d(12, 0, 0);
  EXPECT_LT((vehicle_velocity(epoch, told).velocity_v - Eigen::Vector3d(12, 0, 0)).norm(), 1e-13);
  EXPECT_GT((vehicle_velocity(epoch, {{}, 0, {}, told.q_v_b}).velocity_v.tail<2>().norm()), 1);
}

/// Each row of the covariance's Jacobian against a difference: of an error along one state alone.
TEST(VehicleVelocity, CovarianceFollowsEveryState) {
  std::mt19937 rng{42};
  Told told;
  told.layout.add(block::lever_arm, 1).add(block::mounting, 0.2);
  told.q_v_b = so3::exp({0.3, -1.1, 2.0});
  Epoch epoch{foucault::testing::random_state(rng, told.layout.slow_size()), {}};
  constexpr double kStep = 1e-6;
  for (int i = 0; i < told.layout.size(); ++i) {
    StateVector error = StateVector::Zero(told.layout.size());
    error[i] = kStep;
    epoch.covariance = error * error.transpose();
    Epoch there = epoch, back = epoch;
    static_cast<NavState&>(there) = boxplus(epoch, error);
    static_cast<NavState&>(back) = boxplus(epoch, -error);
    const Eigen::Vector3d d =
        (vehicle_velocity(there, told).velocity_v - vehicle_velocity(back, told).velocity_v) / 2;
    const Eigen::Matrix3d C = vehicle_velocity(epoch, told).covariance_v;
    // Second differences of 1e-12 of some 100 m/s, beside d of 1e-4.
    EXPECT_LT((C - d * d.transpose()).norm(), 1e-6 * C.norm() + 1e-18) << i;
  }
}

}  // namespace
}  // namespace foucault::state
