#include "foucault/evaluation/run_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

state::Epoch epoch_at(double t) {
  state::Epoch epoch;
  epoch.t_ns = nanoseconds(t);
  epoch.covariance.diagonal().head<9>() << 1, 4, 9, 0.01, 0.01, 0.01, 1e-4, 1e-4, 4e-4;
  return epoch;
}

state::FixResult used_fix(double t, const Eigen::Vector3d& innovation,
                          const Eigen::Vector3d& postfit) {
  state::FixResult fix;
  fix.t_ns = nanoseconds(t);
  fix.innovation_n = innovation;
  fix.innovation_covariance = Eigen::Vector3d(1, 4, 9).asDiagonal();
  fix.postfit_n = postfit;
  return fix;
}

state::ReferenceError error_at(double t, const Eigen::Vector3d& position) {
  state::ReferenceError error;
  error.t_ns = nanoseconds(t);
  error.position_n = position;
  return error;
}

TEST(RunMetrics, OfNothingAreEmpty) {
  const RunMetrics m = RunMetricsCollector(state::Mounting()).metrics();
  EXPECT_EQ(m.epochs, 0);
  EXPECT_EQ(m.duration_s, 0);
  EXPECT_EQ(m.gnss.used, 0);
  EXPECT_EQ(m.gnss.innovation_rms_n, Eigen::Vector3d::Zero());
  EXPECT_FALSE(m.reference);
}

TEST(RunMetrics, CountsEpochsAndDuration) {
  RunMetricsCollector collector{state::Mounting()};
  for (const double t : {10.0, 10.5, 12.25}) collector.epoch(epoch_at(t));
  EXPECT_EQ(collector.metrics().epochs, 3);
  EXPECT_EQ(collector.metrics().duration_s, 2.25);
}

TEST(RunMetrics, FixesByHand) {
  RunMetricsCollector collector{state::Mounting()};
  collector.fix(used_fix(1, {3, 0, 3}, {1, 0, 0}));
  collector.fix(used_fix(2, {4, 2, 0}, {-1, 2, 0}));
  state::FixResult gated = used_fix(3, {1000, 0, 0}, {1000, 0, 0});
  gated.verdict = state::FixVerdict::gated;
  collector.fix(gated);  // counts, but is in no mean
  state::FixResult corrected = gated;
  corrected.verdict = state::FixVerdict::corrected;
  collector.fix(corrected);  // neither
  const GnssMetrics m = collector.metrics().gnss;
  EXPECT_EQ(m.used, 2);
  EXPECT_EQ(m.rejected, 1);
  EXPECT_EQ(m.corrected, 1);
  EXPECT_EQ(m.samples, 2);
  EXPECT_NEAR(m.innovation_rms_n.x(), std::sqrt(12.5), 1e-14);
  EXPECT_NEAR(m.innovation_rms_n.y(), std::sqrt(2), 1e-14);
  EXPECT_NEAR(m.innovation_rms_n.z(), std::sqrt(4.5), 1e-14);
  EXPECT_NEAR(m.postfit_rms_n.x(), 1, 1e-14);
  EXPECT_NEAR(m.postfit_rms_n.y(), std::sqrt(2), 1e-14);
  EXPECT_NEAR(m.mean_nis, ((9 + 1) + (16 + 1)) / 2.0, 1e-13);
}

/// Beside those of used fixes; a fix that was never predicted has none.
TEST(RunMetrics, RejectedFixesByHand) {
  RunMetricsCollector collector{state::Mounting()};
  for (const double north : {3.0, 4.0}) {
    state::FixResult gated = used_fix(1, {north, 2, 0}, {0, 0, 0});
    gated.verdict = state::FixVerdict::gated;
    collector.fix(gated);
  }
  state::FixResult late;
  late.verdict = state::FixVerdict::out_of_order;
  collector.fix(late);
  const GnssMetrics m = collector.metrics().gnss;
  EXPECT_EQ(m.rejected, 3);
  EXPECT_EQ(m.rejected_samples, 2);
  EXPECT_NEAR(m.rejected_innovation_rms_n.x(), std::sqrt(12.5), 1e-14);
  EXPECT_NEAR(m.rejected_innovation_rms_n.y(), 2, 1e-14);
  EXPECT_NEAR(m.rejected_mean_nis, ((9 + 1) + (16 + 1)) / 2.0, 1e-13);
}

TEST(RunMetrics, StatisticsStartLaterThanCounts) {
  RunMetricsCollector collector(state::Mounting(), nanoseconds(2));
  for (const double t : {0.0, 1.0, 2.0, 3.0}) {
    const double size = t < 2 ? 100 : 1;
    collector.epoch(epoch_at(t));
    collector.fix(used_fix(t, {size, 0, 0}, {0, 0, 0}));
    collector.reference_error(epoch_at(t), error_at(t, {0, size, 0}));
  }
  const RunMetrics m = collector.metrics();
  EXPECT_EQ(m.epochs, 4);
  EXPECT_EQ(m.duration_s, 3);
  EXPECT_EQ(m.gnss.used, 4);
  EXPECT_EQ(m.gnss.samples, 2);
  EXPECT_EQ(m.gnss.innovation_rms_n.x(), 1);
  EXPECT_EQ(m.reference->samples, 2);
  EXPECT_EQ(m.reference->horizontal_rmse, 1);
}

TEST(RunMetrics, ReferenceByHand) {
  RunMetricsCollector collector{state::Mounting()};
  state::ReferenceError first = error_at(1, {3, 4, 2});
  first.velocity_n = Eigen::Vector3d(0.1, 0.2, 0.2);
  first.euler = Eigen::Vector3d(0.01, -0.02, 0.05);
  collector.reference_error(epoch_at(1), first);
  collector.reference_error(epoch_at(2), error_at(2, {0.5, 0, 0}));

  const ReferenceMetrics m = *collector.metrics().reference;
  EXPECT_EQ(m.samples, 2);
  EXPECT_NEAR(m.horizontal_rmse, std::sqrt((25 + 0.25) / 2), 1e-14);
  EXPECT_NEAR(m.vertical_rmse, std::sqrt(2), 1e-14);
  EXPECT_NEAR(*m.velocity_rmse, 0.3, 1e-14);
  EXPECT_NEAR(*m.roll_rmse, 0.01, 1e-16);
  EXPECT_NEAR(*m.pitch_rmse, 0.02, 1e-16);
  EXPECT_NEAR(*m.heading_rmse, 0.05, 1e-16);
  EXPECT_NEAR(*m.position_nees, ((9 / 1.0 + 16 / 4.0 + 4 / 9.0) + 0.25) / 2, 1e-13);
  EXPECT_NEAR(*m.velocity_nees, (0.01 + 0.04 + 0.04) / 0.01, 1e-12);
  // Sigmas 1, 2, 3 m: 3 m north is on the border of 3 sigma, 4 m east on that of 2.
  Eigen::Matrix3d inside;
  inside << 0.5, 0.5, 1, 0.5, 1, 1, 1, 1, 1;
  EXPECT_EQ(m.position_inside.fraction, inside);
  EXPECT_EQ(m.position_inside.samples, 2);
  // Level and north, roll, pitch, heading have sigmas 0.01, 0.01, 0.02.
  EXPECT_EQ(m.attitude_inside.samples, 1);
  EXPECT_EQ(m.attitude_inside.fraction.row(1), Eigen::RowVector3d(0, 1, 1));
  EXPECT_EQ(m.attitude_inside.fraction.row(2), Eigen::RowVector3d(0, 0, 1));
}

TEST(RunMetrics, NoCovarianceGivesNoNees) {
  RunMetricsCollector collector{state::Mounting()};
  state::Epoch epoch = epoch_at(1);
  epoch.covariance.setZero();
  collector.reference_error(epoch, error_at(1, {1, 1, 1}));
  EXPECT_FALSE(collector.metrics().reference->position_nees);
  EXPECT_EQ(collector.metrics().reference->position_inside.fraction, Eigen::Matrix3d::Zero());
}

TEST(RunMetrics, AttitudeNeesIsThreeForErrorsOfTheirCovariance) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  state::Mounting mounting;
  mounting.q_v_b = so3::exp({0.4, 1.2, -2});
  Eigen::Matrix3d root;
  root << 2e-3, 0, 0, 1e-3, 3e-3, 0, -1e-3, 5e-4, 1e-2;
  const so3::Euler truth{0.2, 0.8, 6.28};
  RunMetricsCollector collector(mounting);
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    state::Epoch epoch;
    epoch.covariance.block<3, 3>(6, 6) = root * root.transpose();
    const Eigen::Vector3d dtheta = root * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
    epoch.q_n_b = so3::from_euler(truth) * mounting.q_v_b * so3::exp(-dtheta);
    const so3::Euler estimate = so3::to_euler(epoch.q_n_b * mounting.q_v_b.conjugate());
    state::ReferenceError error;
    error.euler = Eigen::Vector3d(estimate.roll - truth.roll, estimate.pitch - truth.pitch,
                                  so3::wrap(estimate.heading - truth.heading));
    collector.reference_error(epoch, error);
  }
  const ReferenceMetrics m = *collector.metrics().reference;
  // Chi-square of 3 degrees: sigma of the mean sqrt(6 / n) = 0.017; four times that.
  EXPECT_NEAR(*m.attitude_nees, 3, 0.07);
  for (int axis = 0; axis < 3; ++axis) {
    // Sigma of a fraction sqrt(p (1 - p) / n): 0.0033, 0.0015; four times, and Euler's curvature.
    EXPECT_NEAR(m.attitude_inside.fraction(axis, 0), 0.6827, 0.015);
    EXPECT_NEAR(m.attitude_inside.fraction(axis, 1), 0.9545, 0.007);
  }
}

TEST(RunMetrics, AidsAreCountedAndJudged) {
  RunMetricsCollector collector{state::Mounting()};
  for (int i = 0; i < 20; ++i) {
    collector.observation({nanoseconds(i), "gnss_velocity", 3, 12, true});
    collector.observation({nanoseconds(i), "speed", 1, 16, true});
    collector.observation({nanoseconds(i), "heading", 1, 1.2, true});
  }
  collector.observation({nanoseconds(21.0), "gnss_velocity", 3, 1000, false});
  const RunMetrics m = collector.metrics();
  EXPECT_EQ(m.aids.at("gnss_velocity").used, 20);
  EXPECT_EQ(m.aids.at("gnss_velocity").rejected, 1);
  EXPECT_EQ(m.aids.at("gnss_velocity").mean_nis(), 12);
  const std::string reasons = ::testing::PrintToString(m.trust.reasons);
  EXPECT_NE(reasons.find("of gnss_velocity are 2.0 times"), std::string::npos) << reasons;
  EXPECT_NE(reasons.find("of speed are 4.0 times"), std::string::npos) << reasons;
  EXPECT_EQ(reasons.find("heading"), std::string::npos) << reasons;
}

TEST(Trust, AnAidWithSigmasFarTooSmallCondemns) {
  Consistency good;
  good.nis.samples = 100;
  good.nis.effective_samples = 100;
  good.nis.mean = 3;
  const StateCount states{100, 0, 0, 0};
  EXPECT_TRUE(trust_in(good, states, {{"a", {3, 100, 0, 100 * 12.0}}}).trustworthy);
  EXPECT_FALSE(trust_in(good, states, {{"a", {3, 100, 0, 100 * 30.0}}}).trustworthy);
  EXPECT_TRUE(trust_in(good, states, {{"a", {3, 5, 0, 5 * 30.0}}}).trustworthy);
}

TEST(RunMetrics, SlowBlocksByName) {
  const state::Layout layout =
      state::Layout().add(state::block::gyro_scale, 1e-3).add({"other", 1, "m"}, 2);
  state::Epoch epoch = state::with_slow_blocks(epoch_at(1), layout);
  epoch.slow << 1, 2, 3, 4;
  const std::vector<CalibratedBlock> blocks = calibrated_blocks(epoch, layout);
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].block.name, "gyro_scale");
  EXPECT_EQ(blocks[0].value, (std::vector<double>{1, 2, 3}));
  EXPECT_DOUBLE_EQ(blocks[0].sigma[2], 1e-3);
  EXPECT_EQ(blocks[1].value, std::vector<double>{4});
  EXPECT_DOUBLE_EQ(blocks[1].sigma[0], 2);
}

TEST(NormalizedSquare, UsesTheWholeCovariance) {
  Eigen::Matrix3d P;
  P << 2, 1, 0, 1, 2, 0, 0, 0, 1;
  // P^-1 of the first two is [2 -1; -1 2] / 3.
  EXPECT_NEAR(*normalized_square({1, 1, 0}, P), 2.0 / 3, 1e-14);
  EXPECT_NEAR(*normalized_square({1, -1, 2}, P), 2 + 4, 1e-14);
  EXPECT_FALSE(normalized_square({1, 0, 0}, -P));
}

/// As one of degrees without their minutes: told, and no accuracy.
TEST(RunMetrics, AReferenceOfAnotherPlaceIsNotComparedWith) {
  RunMetricsCollector collector{state::Mounting()};
  for (int i = 0; i < 10; ++i) {
    collector.reference_error(epoch_at(i), error_at(i, {62000.0 - i, 10, 1}));
  }
  const RunMetrics m = collector.metrics();
  EXPECT_FALSE(m.reference);
  EXPECT_FALSE(m.consistency.position_nees);
  EXPECT_NEAR(m.reference_elsewhere_m.value(), 61995, 1);
  for (int i = 10; i < 20; ++i) {  // as far, but by a state that knows
    state::Epoch lost = epoch_at(i);
    lost.covariance.diagonal().head<2>().setConstant(1e8);
    collector.reference_error(lost, error_at(i, {62000.0, 10, 1}));
  }
  EXPECT_TRUE(collector.metrics().reference);
  EXPECT_FALSE(collector.metrics().reference_elsewhere_m);
}

}  // namespace
}  // namespace foucault::evaluation
