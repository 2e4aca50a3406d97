#include "foucault/simulation/gnss_simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::simulation {
namespace {

GnssFix fix_at(const Trajectory& truth, const ScenarioOptions& options, double t) {
  GnssSimulator simulator(options);
  return simulator.measure(truth.at(t), std::llround(t * 1e9), t);
}

TEST(GnssSimulator, AntennaIsOneLeverArmAway) {
  ScenarioOptions options;
  options.duration_s = 200;
  options.gnss_noise = false;
  options.lever_arm_m = {1.5, -0.7, -2.0};
  options.mounting_deg = {10, -20, 130};
  const Trajectory truth = make_trajectory(options);
  for (double t = 0; t < 200; t += 3.3) {
    const Motion motion = truth.at(t);
    const GnssFix fix = fix_at(truth, options, t);
    const Eigen::Vector3d arm_n = geodesy::LocalFrame(motion.position).to_local(fix.antenna);
    // Geodetic coordinates and back: a few nm.
    EXPECT_LT((arm_n - motion.q_n_v * options.lever_arm_m).norm(), 2e-8);
    EXPECT_LT((options.q_v_b() * fix.p_b_a - options.lever_arm_m).norm(), 1e-14);
  }
}

TEST(GnssSimulator, LeverArmErrorMovesTheAntennaAndNotWhatIsTold) {
  ScenarioOptions options;
  options.duration_s = 100;
  options.gnss_noise = false;
  options.gnss_velocity_sigma_m_s = 0.03;
  options.mounting_deg = {10, -20, 130};
  const Trajectory truth = make_trajectory(options);
  ScenarioOptions wrong = options, other = options;
  wrong.lever_arm_error_m = {0.05, -0.03, 0.2};
  other.lever_arm_m += wrong.lever_arm_error_m;
  for (double t = 0; t < 100; t += 3.3) {
    const GnssFix fix = fix_at(truth, wrong, t);
    const GnssFix moved = fix_at(truth, other, t);
    EXPECT_EQ(fix.p_b_a, fix_at(truth, options, t).p_b_a);
    EXPECT_EQ(fix.antenna.latitude, moved.antenna.latitude);
    EXPECT_EQ(fix.antenna.longitude, moved.antenna.longitude);
    EXPECT_EQ(fix.antenna.height, moved.antenna.height);
    EXPECT_EQ(*fix.velocity_n, *moved.velocity_n);
  }
}

TEST(GnssSimulator, VelocityIsTheAntennas) {
  ScenarioOptions options;
  options.duration_s = 200;
  options.gnss_noise = false;
  options.lever_arm_m = {1.5, -0.7, -2.0};
  options.gnss_velocity_sigma_m_s = 0.03;
  const Trajectory truth = make_trajectory(options);
  const double h = 0.01;
  for (double t = 1; t < 200; t += 3.3) {
    const geodesy::LocalFrame frame(truth.at(t).position);
    const Eigen::Vector3d before = frame.to_local(fix_at(truth, options, t - h).antenna);
    const Eigen::Vector3d after = frame.to_local(fix_at(truth, options, t + h).antenna);
    const GnssFix fix = fix_at(truth, options, t);
    ASSERT_TRUE(fix.velocity_n.has_value());
    // Central difference: h^2/6 times a jerk of a few m/s^3.
    EXPECT_LT(((after - before) / (2 * h) - *fix.velocity_n).norm(), 1e-4);
    EXPECT_DOUBLE_EQ(fix.velocity_covariance(1, 1), 9e-4);
  }
}

// 20000 draws: a variance is known to 1 %, a mean to 0.7 % of sigma.
TEST(GnssSimulator, NoiseIsAsReported) {
  ScenarioOptions options;
  options.name = "static";
  options.duration_s = 10;
  options.gnss_sigma_m = {0.01, 0.02, 0.05};
  options.gnss_velocity_sigma_m_s = 0.1;
  options.lever_arm_m.setZero();
  const Motion motion = make_trajectory(options).at(5);
  const geodesy::LocalFrame frame(motion.position);
  GnssSimulator simulator(options);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero();
  double velocity_square = 0;
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const GnssFix fix = simulator.measure(motion, i, 5);
    const Eigen::Vector3d scaled = frame.to_local(fix.antenna).cwiseQuotient(options.gnss_sigma_m);
    mean += scaled / count;
    square += scaled.cwiseAbs2() / count;
    velocity_square += fix.velocity_n->squaredNorm() / 3 / count;
    EXPECT_TRUE(fix.position_covariance.diagonal().cwiseSqrt().isApprox(options.gnss_sigma_m));
  }
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 0.03);
  EXPECT_LT((square - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.04);
  EXPECT_NEAR(velocity_square, 0.01, 0.0004);
}

// Half white, 1.5 of Gauss-Markov noise: variance 0.25 + 2.25, correlation after k fixes 2.25/2.5
// e^(-k/20). 40000 fixes of three axes are 3000 independent ones of tau 20: 2.6 % of a variance.
TEST(GnssSimulator, ColouredNoiseHasItsSigmaAndCorrelation) {
  ScenarioOptions options;
  options.name = "static";
  options.duration_s = 10;
  options.gnss_white_sigma = 0.5;
  options.gnss_coloured_sigma = 1.5;
  options.gnss_coloured_tau_s = 40;
  options.lever_arm_m.setZero();
  const Motion motion = make_trajectory(options).at(5);
  const geodesy::LocalFrame frame(motion.position);
  GnssSimulator simulator(options);
  std::vector<Eigen::Vector3d> noise;
  for (int i = 0; i < 40000; ++i) {
    const GnssFix fix = simulator.measure(motion, i, 2 * i);
    noise.push_back(frame.to_local(fix.antenna).cwiseQuotient(options.gnss_sigma_m));
    EXPECT_TRUE(fix.position_covariance.diagonal().cwiseSqrt().isApprox(options.gnss_sigma_m));
  }
  const auto covariance = [&](std::size_t lag) {
    double sum = 0;
    for (std::size_t i = lag; i < noise.size(); ++i) sum += noise[i].dot(noise[i - lag]) / 3;
    return sum / static_cast<double>(noise.size() - lag);
  };
  EXPECT_NEAR(covariance(0), 2.5, 0.25);
  EXPECT_NEAR(covariance(0) - covariance(1), 0.25 + 2.25 * (1 - std::exp(-0.05)), 0.02);
  EXPECT_NEAR(covariance(20), 2.25 * std::exp(-1), 0.25);
  EXPECT_NEAR(covariance(200), 0, 0.25);
}

TEST(GnssSimulator, ReportsTheQualityThatItIsTold) {
  ScenarioOptions options;
  options.duration_s = 100;
  options.gnss_quality = "single";
  options.gnss_degraded_start_s = 50;
  options.gnss_degraded_length_s = 20;
  const Trajectory truth = make_trajectory(options);
  EXPECT_EQ(fix_at(truth, options, 49.9).quality, FixQuality::single);
  EXPECT_EQ(fix_at(truth, options, 50).quality, FixQuality::float_rtk);
}

TEST(GnssSimulator, DegradesWithinItsWindow) {
  ScenarioOptions options;
  options.duration_s = 100;
  options.gnss_degraded_start_s = 50;
  options.gnss_degraded_length_s = 20;
  const Trajectory truth = make_trajectory(options);
  EXPECT_EQ(fix_at(truth, options, 49.9).quality, FixQuality::fixed_rtk);
  EXPECT_EQ(fix_at(truth, options, 50).quality, FixQuality::float_rtk);
  EXPECT_NEAR(fix_at(truth, options, 60).position_covariance(2, 2), 0.04, 1e-12);
  EXPECT_NEAR(fix_at(truth, options, 70).position_covariance(2, 2), 0.0004, 1e-12);
  EXPECT_FALSE(fix_at(truth, options, 60).velocity_n.has_value());
}

// 20000 draws: a variance is known to 1 %, a mean to 0.7 % of sigma.
TEST(GnssSimulator, HeadingIsThatOfTheBaselineWithItsNoise) {
  ScenarioOptions options;
  options.name = "static";
  options.duration_s = 10;
  options.heading_deg = 170;
  options.heading_sigma_deg = 0.4;
  options.heading_noise_factor = 3;
  options.heading_baseline_error_deg = 15;
  const Motion motion = make_trajectory(options).at(5);
  GnssSimulator simulator(options);
  double mean = 0, square = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const GnssFix fix = simulator.measure(motion, i, i);
    ASSERT_TRUE(fix.heading);
    EXPECT_DOUBLE_EQ(fix.heading->sigma, 0.4 * kDegree);
    const double error = so3::wrap(fix.heading->azimuth - 185 * kDegree) / kDegree;
    mean += error / kCount;
    square += error * error / kCount;
  }
  EXPECT_NEAR(mean, 0, 0.04);  // and what tilts of a degree turn the baseline's azimuth by
  EXPECT_NEAR(std::sqrt(square), 1.2, 0.02);
}

TEST(GnssSimulator, HeadingLeavesOtherDrawsAlone) {
  ScenarioOptions options;
  options.duration_s = 60;
  const Trajectory truth = make_trajectory(options);
  ScenarioOptions with = options;
  with.heading_sigma_deg = 0.5;
  with.heading_outlier_percent = 100;
  GnssSimulator plain(options), heading(with);
  int far = 0;
  for (int i = 0; i < 60; ++i) {
    const GnssFix a = plain.measure(truth.at(i), i, i), b = heading.measure(truth.at(i), i, i);
    EXPECT_EQ(a.antenna.latitude, b.antenna.latitude);
    EXPECT_FALSE(a.heading);
    const double error = b.heading->azimuth - so3::to_euler(truth.at(i).q_n_v).heading;
    if (std::abs(so3::wrap(error)) > 10 * kDegree) ++far;
  }
  EXPECT_GT(far, 45);  // of 60, 1 in 18 falls near by chance
}

}  // namespace
}  // namespace foucault::simulation
