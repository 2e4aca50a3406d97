#include "foucault/measurement/body_stretch.h"

#include <gtest/gtest.h>

#include "foucault/core/so3.h"
#include "foucault/measurement/nonholonomic.h"
#include "foucault/measurement/wheel_speed.h"
#include "foucault/simulation/imu_simulator.h"
#include "foucault/simulation/scenario.h"

namespace foucault::measurement {
namespace {

constexpr int64_t kStepNs = 5'000'000;

simulation::Trajectory city() {
  simulation::ScenarioOptions options;
  options.duration_s = 200;
  options.seed = 8;
  return simulation::make_trajectory(options);
}

/// What a perfect IMU and the truth say of a second that ends at t.
struct Second {
  BodyStretch stretch;
  state::NavState end;
  Eigen::Vector3d mean_velocity_b = Eigen::Vector3d::Zero();
};

Second second_until(const simulation::Trajectory& way, double t, const state::ImuBias& bias,
                    const Eigen::Quaterniond& q_v_b) {
  Second out;
  BodyStretchBuilder builder;
  const int64_t end_ns = static_cast<int64_t>(t * 1e9);
  const int steps = 200;
  builder.start(end_ns - steps * kStepNs, bias);
  for (int i = 0; i < steps; ++i) {
    const int64_t begin_ns = end_ns - (steps - i) * kStepNs;
    ImuIncrement increment =
        simulation::exact_increment(way, q_v_b, 0, begin_ns, begin_ns + kStepNs);
    increment.dtheta_b += bias.gyro * increment.dt();
    increment.dvel_b += bias.accel * increment.dt();
    builder.add(increment);
    builder.mark();
    const simulation::Motion m = way.at(1e-9 * static_cast<double>(begin_ns + kStepNs));
    out.mean_velocity_b += (m.q_n_v * q_v_b).conjugate() * m.velocity_n / steps;
  }
  out.stretch = *builder.stretch();
  const simulation::Motion m = way.at(t);
  out.end.position = m.position;
  out.end.velocity_n = m.velocity_n;
  out.end.q_n_b = m.q_n_v * q_v_b;
  out.end.bias = bias;
  return out;
}

const state::ImuBias kBias{{0.01, -0.02, 0.03}, {0.1, -0.2, 0.3}};

/// Sculling within 5 ms and the turn of n, 7e-5 rad/s of 15 m/s for half a second.
TEST(BodyStretch, MeanVelocityIsThatOfTheWay) {
  const simulation::Trajectory way = city();
  const Eigen::Quaterniond q_v_b = so3::from_euler({0.3, -0.5, 2});
  for (double t = 41; t < 199; t += 3.3) {
    const Second second = second_until(way, t, kBias, q_v_b);
    const BodyVelocity u = body_velocity(second.stretch, second.end);
    EXPECT_LT((u.value_b - second.mean_velocity_b).norm(), 1.5e-3) << t;
  }
}

/// A bias that was taken off wrongly is made good to first order.
TEST(BodyStretch, FollowsTheBiasesOfTheState) {
  const simulation::Trajectory way = city();
  for (double t = 61; t < 199; t += 7.7) {
    Second second = second_until(way, t, kBias, Eigen::Quaterniond::Identity());
    const Eigen::Vector3d right = body_velocity(second.stretch, second.end).value_b;
    BodyStretch wrong = second.stretch;
    wrong.bias.gyro.z() += 1e-3;  // as if less had been taken off: half a second of 15 m/s
    const Eigen::Vector3d moved = body_velocity(wrong, second.end).value_b;
    EXPECT_NEAR((moved - right).norm(), 0.5e-3 * second.end.velocity_n.norm(),
                1e-4 * second.end.velocity_n.norm() + 1e-6);
  }
}

/// A car of the simulation rolls about its IMU: sideways by centimetres a second at most, where it
/// brakes into a turn, downward by its springs; forward it agrees with its wheels.
TEST(VehiclePoint, OfACarLeavesNoResidualWhereItsWheelsRoll) {
  const simulation::Trajectory way = city();
  const Eigen::Quaterniond q_v_b = so3::from_euler({0.02, -0.05, 0.1});
  double squares = 0;
  int count = 0;
  for (double t = 61; t < 199; t += 1.7) {
    const Second second = second_until(way, t, {}, q_v_b);
    const state::Linearized z =
        Nonholonomic(second.stretch, q_v_b, {0.05, 0.1}).linearize(second.end, {}, state::Layout());
    squares += z.r[0] * z.r[0];
    ++count;
    EXPECT_LT(std::abs(z.r[0]), 0.05) << t;
    EXPECT_LT(std::abs(z.r[1]), 0.3) << t;
    const double speed = (q_v_b * second.mean_velocity_b).x();
    const state::Linearized w = WheelSpeedMean(second.stretch, q_v_b, speed, 0.02)
                                    .linearize(second.end, {}, state::Layout());
    EXPECT_LT(std::abs(w.r[0]), 1.5e-3) << t;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.005);
}

/// Told a degree wrong, it seems to slip by a sixtieth of its speed; the block makes it good.
TEST(VehiclePoint, SeesTheMounting) {
  const simulation::Trajectory way = city();
  const double heading = 0.02;
  const Eigen::Quaterniond told = Eigen::Quaterniond::Identity();
  state::Layout layout;
  layout.add(state::block::mounting, 0.1);
  double most = 0;
  for (double t = 61; t < 199; t += 1.7) {
    Second second = second_until(way, t, {}, so3::exp({0, 0, -heading}).conjugate());
    const Nonholonomic rolls(second.stretch, told, {0.05, 0.1});
    most = std::max(most, std::abs(rolls.linearize(second.end, {}, state::Layout()).r[0]));
    second.end.slow = Eigen::Vector2d(0, heading);
    EXPECT_LT(std::abs(rolls.linearize(second.end, {}, layout).r[0]), 0.05) << t;
  }
  EXPECT_GT(most, 0.2);
}

TEST(BodyStretchBuilder, HasNoneWithoutAnInstant) {
  BodyStretchBuilder builder;
  builder.start(0, {});
  EXPECT_FALSE(builder.stretch());
}

}  // namespace
}  // namespace foucault::measurement
