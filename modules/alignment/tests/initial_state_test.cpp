#include "../src/initial_state.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/state/nav_state.h"

namespace foucault::alignment {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// A true state, and findings about it with errors drawn from what they say of themselves.
class InitialStateTest : public ::testing::Test {
 protected:
  InitialStateTest() {
    noise_.gyro_turn_on_sigma = 2e-3;
    noise_.accel_turn_on_sigma = 0.02;
    noise_.gyro_bias_sigma = noise_.accel_bias_sigma = 1e-6;
    true_.position = {48 * kDegree, 9 * kDegree, 300};
    true_.q_n_b = so3::from_euler({0.01, -0.02, 0.7}) * q_v_b_;
  }

  Vector3d draw(double sigma) {
    return sigma * Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  AlignmentFindings draw_findings() {
    true_.bias = {draw(noise_.gyro_turn_on_sigma), draw(noise_.accel_turn_on_sigma)};
    const Vector3d lever(0.5, -0.4, -1.1), acceleration(0.4, 0.3, -0.1);
    AlignmentFindings f;
    f.q_v_b = q_v_b_;
    f.omega_b = Vector3d(0.02, -0.03, 0.05);
    f.fix.p_b_a = lever;
    const Vector3d swing_n = true_.q_n_b * f.omega_b.cross(lever);
    const Vector3d forward_n = true_.q_n_b * (q_v_b_.conjugate() * Vector3d::UnitX());
    true_.velocity_n = 10 * forward_n;
    const Vector3d antenna_n = true_.velocity_n + swing_n;

    const Vector3d dv = draw(0.05), da = 0.3 * dv + draw(0.02);
    f.motion_covariance.topLeftCorner<3, 3>() = 2.5e-3 * Matrix3d::Identity();
    f.motion_covariance.topRightCorner<3, 3>() = 7.5e-4 * Matrix3d::Identity();
    f.motion_covariance.bottomLeftCorner<3, 3>() = 7.5e-4 * Matrix3d::Identity();
    f.motion_covariance.bottomRightCorner<3, 3>() = (2.25e-4 + 4e-4) * Matrix3d::Identity();
    f.antenna_velocity_n = antenna_n - dv;
    const Geodetic antenna =
        geodesy::LocalFrame(true_.position).to_geodetic(true_.q_n_b * lever + draw(0.02));
    f.fix.antenna = antenna;
    f.fix.position_covariance = 4e-4 * Matrix3d::Identity();

    f.acceleration_n = acceleration;
    f.antenna_velocity_n = antenna_n;
    const Vector3d force_b = true_.q_n_b.conjugate() * specific_force_n(f);
    f.acceleration_n -= da;
    f.antenna_velocity_n -= dv;
    const Vector3d anomaly = 5e-4 * normal_(rng_) * force_b.normalized();
    f.specific_force_b = force_b + true_.bias.accel + draw(0.01) + anomaly;
    f.specific_force_covariance = 1e-4 * Matrix3d::Identity();

    constexpr double kHeadingSigma = 0.02;
    f.heading = geodesy::azimuth(forward_n) + kHeadingSigma * normal_(rng_);
    f.heading_variance = kHeadingSigma * kHeadingSigma;

    f.turn_n = Vector3d(0, 0, 0.05);
    const Vector3d rate_n = geodesy::wgs84::earth_rate_n(antenna.latitude) + f.turn_n;
    f.gyro_b = true_.q_n_b.conjugate() * rate_n + true_.bias.gyro + draw(5e-4);
    f.gyro_covariance = 2.5e-7 * Matrix3d::Identity();
    return f;
  }

  double mean_nees() {
    double sum = 0;
    constexpr int kRuns = 400;
    for (int run = 0; run < kRuns; ++run) {
      const state::Epoch epoch = initial_state(draw_findings(), noise_);
      const state::NodeVector error = state::boxminus(true_, epoch);
      const state::NodeMatrix P = epoch.covariance;
      sum += error.dot(P.ldlt().solve(error));
    }
    return sum / kRuns;
  }

  std::mt19937 rng_{42};
  std::normal_distribution<double> normal_;
  Quaterniond q_v_b_ = so3::from_euler({0.2, 0.1, -0.5});
  imu::ImuNoise noise_;
  state::NavState true_;
};

/// 400 chi-squares of 15 have a mean within 15 +- 0.9, 99.9 %.
TEST_F(InitialStateTest, ErrorsAreThoseOfTheCovariance) { EXPECT_NEAR(mean_nees(), 15, 0.9); }

/// The heading measured by two antennas whose baseline looks aside, by 40 deg as told and by an
/// error that nobody knows: 400 chi-squares of 16 have a mean within 16 +- 0.95, 99.9 %.
TEST_F(InitialStateTest, SharesTheErrorOfTheBaseline) {
  constexpr int kRuns = 400;
  constexpr double kTold = 40 * kDegree, kBaselineSigma = 0.05, kSigma = 0.01;
  state::Layout layout;
  layout.add(state::block::baseline_heading, kBaselineSigma);
  double sum = 0;
  for (int run = 0; run < kRuns; ++run) {
    AlignmentFindings findings = draw_findings();
    const double error = kBaselineSigma * normal_(rng_);
    const double direction = kTold + error;
    const Vector3d along_b =
        q_v_b_.conjugate() * Vector3d(std::cos(direction), std::sin(direction), 0);
    // Used again, hence with the variance doubled.
    const double noise = std::sqrt(2.0) * kSigma * normal_(rng_);
    const double azimuth = geodesy::azimuth(true_.q_n_b * along_b) + noise;
    findings.fix.heading = GnssHeading{azimuth, kSigma, kTold};
    findings = with_antenna_heading(findings);
    const state::Epoch epoch =
        with_baseline_block(initial_state(findings, noise_, layout), findings, layout);
    state::NavState truth = true_;
    truth.slow = state::SlowVector::Constant(1, error);
    const state::StateVector errors = state::boxminus(truth, epoch);
    sum += errors.dot(epoch.covariance.ldlt().solve(errors));
  }
  EXPECT_NEAR(sum / kRuns, 16, 0.95);
}

/// A level errs by the accelerometers' bias: who knows that knows the level, and by nothing else.
TEST_F(InitialStateTest, LevelErrorFollowsFromTheBias) {
  noise_.accel_turn_on_sigma = 0.1;
  double with = 0, without = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const state::Epoch epoch = initial_state(draw_findings(), noise_);
    const state::NodeVector error = state::boxminus(true_, epoch);
    const Matrix3d P_ab =
        state::part(epoch.covariance, state::block::attitude, state::block::accel_bias);
    const Matrix3d P_bb = epoch.covariance_of(state::block::accel_bias);
    const Matrix3d gain = P_bb.ldlt().solve(P_ab.transpose()).transpose();
    const Matrix3d left = epoch.covariance_of(state::block::attitude) - gain * P_ab.transpose();
    const Vector3d a = state::part(error, state::block::attitude);
    const Vector3d unexplained = a - gain * part(error, state::block::accel_bias);
    with += unexplained.dot(left.ldlt().solve(unexplained));
    without += a.dot(left.ldlt().solve(a));
  }
  EXPECT_NEAR(with / kRuns, 3, 0.4);  // chi-square of 3, 99.9 %
  EXPECT_GT(without / kRuns, 10);
}

TEST_F(InitialStateTest, AGyroBiasBeyondItsPriorIsBelieved) {
  AlignmentFindings f = draw_findings();
  const Vector3d large(0.05, 0, 0);
  f.gyro_b += large;
  const state::Epoch epoch = initial_state(f, noise_);
  EXPECT_LT((epoch.bias.gyro - true_.bias.gyro - large).norm(), 3e-3);
}

TEST_F(InitialStateTest, AnAccelerometerBiasBeyondItsPriorWidensIt) {
  AlignmentFindings f = draw_findings();
  const double before = initial_state(f, noise_).sigma_of(state::block::accel_bias).maxCoeff();
  f.specific_force_b *= 1.1;  // 1 m/s^2 too long
  const state::Epoch epoch = initial_state(f, noise_);
  EXPECT_GT(epoch.sigma_of(state::block::accel_bias).maxCoeff(), 5 * before);
  EXPECT_NEAR(epoch.bias.accel.dot(f.specific_force_b.normalized()), 0.98, 0.1);
}

/// Position and velocity of the IMU err by the attitude through the lever arm.
TEST_F(InitialStateTest, GivenAnglesErrAsTheySay) {
  double sum = 0;
  constexpr int kRuns = 400;
  const Vector3d sigma(0.01, 0.02, 0.03);
  const so3::Euler truth = so3::to_euler(true_.q_n_b * q_v_b_.conjugate());
  for (int run = 0; run < kRuns; ++run) {
    AlignmentFindings f = draw_findings();
    const Vector3d d = draw(1).cwiseProduct(sigma);
    const GivenAngles given{GivenAngle{truth.roll + d.x(), sigma.x()},
                            GivenAngle{truth.pitch + d.y(), sigma.y()},
                            GivenAngle{truth.heading + d.z(), sigma.z()}};
    const state::Epoch epoch =
        given_state(f.fix, f.antenna_velocity_n, 2.5e-3 * Matrix3d::Identity(), f.omega_b, q_v_b_,
                    given, noise_);
    const state::NodeVector error = state::boxminus(true_, epoch);
    const state::NodeMatrix P = epoch.covariance;
    sum += error.dot(P.ldlt().solve(error));
  }
  EXPECT_NEAR(sum / kRuns, 15, 0.9);
}

TEST_F(InitialStateTest, AGivenAngleTakesThePlaceOfTheOneFound) {
  const state::Epoch found = initial_state(draw_findings(), noise_);
  GivenAngles given;
  EXPECT_EQ(with_given_angles(found, q_v_b_, given).covariance, found.covariance);
  given.pitch = GivenAngle{0.1, 0.004};
  const state::Epoch epoch = with_given_angles(found, q_v_b_, given);
  const so3::Euler before = so3::to_euler(found.q_n_b * q_v_b_.conjugate());
  const so3::Euler after = so3::to_euler(epoch.q_n_b * q_v_b_.conjugate());
  EXPECT_NEAR(after.roll, before.roll, 1e-12);
  EXPECT_NEAR(after.pitch, 0.1, 1e-12);
  EXPECT_NEAR(after.heading, before.heading, 1e-12);
  const Matrix3d by_b = so3::euler_jacobian(before) * q_v_b_.toRotationMatrix();
  const Matrix3d of_angles = by_b * epoch.covariance_of(state::block::attitude) * by_b.transpose();
  EXPECT_NEAR(std::sqrt(of_angles(1, 1)), 0.004, 1e-9);
  EXPECT_NEAR(of_angles(0, 1), 0, 1e-12);
}

}  // namespace
}  // namespace foucault::alignment
