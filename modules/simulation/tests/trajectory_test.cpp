#include "foucault/simulation/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <random>
#include <string>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/simulation/scenario.h"

namespace foucault::simulation {
namespace {

Eigen::Matrix3d R_e_n(const Motion& motion) {
  return geodesy::wgs84::R_e_n(motion.position.latitude, motion.position.longitude);
}

Eigen::Vector3d velocity_e(const Motion& motion) { return R_e_n(motion) * motion.velocity_n; }

/// Attitude in an inertial frame that coincides with e at t = 0.
Eigen::Quaterniond q_i_v(const Trajectory& trajectory, double t) {
  const Motion motion = trajectory.at(t);
  const Eigen::AngleAxisd earth_turn(geodesy::wgs84::kEarthRate * t, Eigen::Vector3d::UnitZ());
  return Eigen::Quaterniond(earth_turn) * Eigen::Quaterniond(R_e_n(motion)) * motion.q_n_v;
}

/// Derivative by central differences of fourth order. `function` gives vectors.
template <class Function>
Eigen::Vector3d derivative(const Function& function, double t, double h) {
  const Eigen::Vector3d near = function(t + h) - function(t - h);
  const Eigen::Vector3d far = function(t + 2 * h) - function(t - 2 * h);
  return (8 * near - far) / (12 * h);
}

struct Case {
  std::string scenario;
  double latitude_deg, longitude_deg;
  double vibration_m_s2, vibration_deg;
};

void PrintTo(const Case& test, std::ostream* out) { *out << test.scenario; }

class TrajectoryOf : public ::testing::TestWithParam<Case> {
 protected:
  Trajectory trajectory() const {
    ScenarioOptions options;
    options.name = GetParam().scenario;
    options.latitude_deg = GetParam().latitude_deg;
    options.longitude_deg = GetParam().longitude_deg;
    options.vibration_m_s2 = GetParam().vibration_m_s2;
    options.vibration_deg = GetParam().vibration_deg;
    options.vibration_hz = 5;
    options.vibration_growth = 0.5;
    options.duration_s = 900;
    return make_trajectory(options);
  }
  std::vector<double> instants() const {
    std::mt19937 rng{42};
    std::uniform_real_distribution<double> uniform(1, 899);
    std::vector<double> times(300);
    for (double& t : times) t = uniform(rng);
    return times;
  }
};

TEST_P(TrajectoryOf, VelocityIsTheDerivativeOfPosition) {
  const Trajectory truth = trajectory();
  const auto p = [&](double t) -> Eigen::Vector3d { return truth.at(t).p_e - truth.at(1).p_e; };
  for (double t : instants()) {
    // ECEF metres are rounded to 1 nm: 1e-9 / h = 3e-7 m/s.
    EXPECT_LT((derivative(p, t, 0.003) - velocity_e(truth.at(t))).norm(), 2e-6) << "t " << t;
  }
}

TEST_P(TrajectoryOf, GeodeticPositionIsThatOfEcef) {
  const Trajectory truth = trajectory();
  for (double t : instants()) {
    const Motion motion = truth.at(t);
    EXPECT_LT((geodesy::wgs84::geodetic_to_ecef(motion.position) - motion.p_e).norm(), 1e-8);
  }
}

TEST_P(TrajectoryOf, SpecificForceIsInertialAccelerationMinusGravitation) {
  const Trajectory truth = trajectory();
  const Eigen::Vector3d omega(0, 0, geodesy::wgs84::kEarthRate);
  for (double t : instants()) {
    const Motion motion = truth.at(t);
    // Acceleration in the inertial frame that coincides with e at t.
    const auto v_i = [&](double at) -> Eigen::Vector3d {
      const Motion m = truth.at(at);
      const Eigen::AngleAxisd turn(geodesy::wgs84::kEarthRate * (at - t), Eigen::Vector3d::UnitZ());
      return turn * Eigen::Vector3d(velocity_e(m) + omega.cross(m.p_e));
    };
    const Eigen::Vector3d a_i = derivative(v_i, t, 0.004);
    const double gravity =
        geodesy::wgs84::normal_gravity(motion.position.latitude, motion.position.height);
    const Eigen::Vector3d gravity_e = R_e_n(motion) * Eigen::Vector3d(0, 0, gravity);
    const Eigen::Vector3d gravitation = gravity_e + omega.cross(omega.cross(motion.p_e));
    const Eigen::Vector3d f_e = R_e_n(motion) * (motion.q_n_v * motion.f_v);
    // Truncation: h^4/30 times the fifth derivative of v (a vibration at 5 Hz: 1e6 m/s^6 per
    // m/s^2); rounding of v_i (465 m/s): 1e-13 / h.
    EXPECT_LT((f_e - (a_i - gravitation)).norm(), 2e-5) << "t " << t;
  }
}

TEST_P(TrajectoryOf, AngularRateIsTheDerivativeOfInertialAttitude) {
  const Trajectory truth = trajectory();
  for (double t : instants()) {
    const Eigen::Quaterniond here = q_i_v(truth, t);
    const auto angle = [&](double at) -> Eigen::Vector3d {
      return so3::log(here.conjugate() * q_i_v(truth, at));
    };
    EXPECT_LT((derivative(angle, t, 0.004) - truth.at(t).omega_iv_v).norm(), 2e-6) << "t " << t;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, TrajectoryOf,
    ::testing::Values(Case{"city", 30.45, 114.47, 0, 0}, Case{"city", -33, 18, 1, 0.1},
                      Case{"motorway", 50, 8, 0, 0}, Case{"airliner", 30.45, 114.47, 0, 0},
                      Case{"airliner", 80, 179.99, 0, 0}, Case{"walk", 50, 8, 0, 0},
                      Case{"boat", 60, -179.999, 0, 0}, Case{"copter", -33, 18, 0, 0}),
    [](const auto& test) { return test.param.scenario + std::to_string(test.index); });

TEST(Trajectory, AtRestFeelsGravityAndEarthRateOnly) {
  for (const std::string& name : scenario_names()) {
    ScenarioOptions options;
    options.name = name;
    options.duration_s = 300;
    const Trajectory truth = make_trajectory(options);
    for (double t = 0; t < 35; t += 1.7) {
      const Motion motion = truth.at(t);
      const double gravity =
          geodesy::wgs84::normal_gravity(motion.position.latitude, motion.position.height);
      EXPECT_EQ(motion.velocity_n, Eigen::Vector3d::Zero());
      // Rounding only.
      EXPECT_NEAR(motion.f_v.norm(), gravity, 1e-14);
      EXPECT_NEAR(motion.omega_iv_v.norm(), geodesy::wgs84::kEarthRate, 1e-19);
      EXPECT_LT((motion.q_n_v * motion.f_v - Eigen::Vector3d(0, 0, -gravity)).norm(), 1e-14);
    }
  }
}

TEST(Trajectory, SplineAnglesAreRollPitchHeading) {
  const std::vector<Eigen::Vector3d> here(8, Eigen::Vector3d::Zero());
  const std::vector<Eigen::Vector3d> angles(8, Eigen::Vector3d(0.1, -0.2, 4.0));
  const Trajectory truth({50 * kDegree, 8 * kDegree, 100}, QuinticSpline(1, here),
                         QuinticSpline(1, angles));
  const so3::Euler euler = so3::to_euler(truth.at(0.5).q_n_v);
  EXPECT_NEAR(euler.roll, 0.1, 1e-12);
  EXPECT_NEAR(euler.pitch, -0.2, 1e-12);
  EXPECT_NEAR(euler.heading, 4.0, 1e-12);
}

}  // namespace
}  // namespace foucault::simulation
