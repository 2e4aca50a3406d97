#include "foucault/simulation/wheel_simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "foucault/geodesy/wgs84.h"

namespace foucault::simulation {
namespace {

ScenarioOptions city_trip() {
  ScenarioOptions options;
  options.duration_s = 200;
  options.wheel_lever_arm_m = {-1.5, 0.4, 0.6};
  return options;
}

Eigen::Vector3d point_e(const Motion& motion, const Eigen::Vector3d& p_v_x) {
  const Eigen::Matrix3d R_e_n =
      geodesy::wgs84::R_e_n(motion.position.latitude, motion.position.longitude);
  return motion.p_e + R_e_n * (motion.q_n_v * p_v_x);
}

TEST(WheelSimulator, IsTheForwardVelocityOfItsPoint) {
  const ScenarioOptions options = city_trip();
  const Trajectory truth = make_trajectory(options);
  WheelSimulator wheels(options);
  const double h = 0.01;
  double difference_to_imu = 0;
  for (double t = 42; t < 199; t += 0.7) {
    const Motion motion = truth.at(t);
    const Eigen::Matrix3d R_e_n =
        geodesy::wgs84::R_e_n(motion.position.latitude, motion.position.longitude);
    const Eigen::Vector3d velocity_e = (point_e(truth.at(t + h), options.wheel_lever_arm_m) -
                                        point_e(truth.at(t - h), options.wheel_lever_arm_m)) /
                                       (2 * h);
    const Eigen::Vector3d velocity_v = motion.q_n_v.conjugate() * (R_e_n.transpose() * velocity_e);
    const WheelSpeed speed = wheels.measure(motion, 17);
    EXPECT_EQ(speed.t_ns, 17);
    // Central difference: h^2/6 times a jerk of a few m/s^3. Slower than 1 mm/s is none.
    EXPECT_NEAR(speed.forward, velocity_v.x(), std::abs(velocity_v.x()) < 2e-3 ? 1e-3 : 1e-4);
    const Eigen::Vector3d imu_v = motion.q_n_v.conjugate() * motion.velocity_n;
    difference_to_imu = std::max(difference_to_imu, std::abs(imu_v.x() - velocity_v.x()));
  }
  // A point 0.4 m to the right is slower by 0.4 m times a yaw rate of 0.5 rad/s.
  EXPECT_GT(difference_to_imu, 0.1);
}

TEST(WheelSimulator, ScalesAndRounds) {
  ScenarioOptions options = city_trip();
  const Trajectory truth = make_trajectory(options);
  WheelSimulator exact(options);
  options.wheel_scale_percent = 1.5;
  WheelSimulator scaled(options);
  options.wheel_step_m_s = 0.01;
  WheelSimulator rounded(options);
  for (double t = 45; t < 199; t += 0.7) {
    const Motion motion = truth.at(t);
    const double speed = exact.measure(motion, 0).forward;
    EXPECT_NEAR(scaled.measure(motion, 0).forward, 1.015 * speed, 1e-12);
    const double steps = rounded.measure(motion, 0).forward / 0.01;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_NEAR(0.01 * steps, 1.015 * speed, 0.005 + 1e-12);
  }
}

// 20000 draws: a variance is known to 1 %, a mean to 0.7 % of sigma.
TEST(WheelSimulator, NoiseIsWhiteAndNotOfWheelsThatStand) {
  ScenarioOptions options = city_trip();
  options.wheel_sigma_m_s = 0.02;
  const Trajectory truth = make_trajectory(options);
  const Motion drives = truth.at(60), stands = truth.at(20);
  ScenarioOptions quiet = options;
  quiet.wheel_sigma_m_s = 0;
  const double speed = WheelSimulator(quiet).measure(drives, 0).forward;
  ASSERT_GT(speed, 1);
  WheelSimulator wheels(options);
  double mean = 0, square = 0, product = 0, last = 0;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(wheels.measure(stands, 0).forward, 0);
    const double noise = (wheels.measure(drives, 0).forward - speed) / 0.02;
    mean += noise / count;
    square += noise * noise / count;
    product += noise * last / count;
    last = noise;
  }
  EXPECT_NEAR(mean, 0, 0.03);
  EXPECT_NEAR(square, 1, 0.04);
  EXPECT_NEAR(product, 0, 0.03);
}

}  // namespace
}  // namespace foucault::simulation
