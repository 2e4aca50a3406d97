#include "foucault/evaluation/drift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kBegin = 1'600'000'000'000'000'000;
const Outage kOutage{3, kBegin, kBegin + 60 * kNanosecondsPerSecond};
const Geodetic kHome{0.84, 0.2, 500};

int64_t after_begin(double seconds) { return kBegin + nanoseconds(seconds); }

TEST(Drift, MaximumEndAndMarks) {
  const OutageDrift d =
      outage_drift(kOutage, {{1, {3, 4, 1}}, {10, {6, 8, -7}}, {11, {0, 1, 0}}, {21, {0, 2, 2}}},
                   {5, 10, 10.5, 15, 60});
  EXPECT_EQ(d.maximum.horizontal, 10);
  EXPECT_EQ(d.maximum.vertical, 7);
  EXPECT_EQ(d.end.horizontal, 2);
  EXPECT_EQ(d.end.vertical, 2);
  ASSERT_EQ(d.at_marks.size(), 5u);
  EXPECT_FALSE(d.at_marks[0]);  // 1 s and 10 s are too far apart
  EXPECT_EQ(d.at_marks[1]->horizontal, 10);
  EXPECT_EQ(d.at_marks[1]->vertical, 7);
  EXPECT_NEAR(d.at_marks[2]->horizontal, std::hypot(3, 4.5), 1e-14);
  EXPECT_NEAR(d.at_marks[2]->vertical, 3.5, 1e-14);
  EXPECT_FALSE(d.at_marks[3]);
  EXPECT_FALSE(d.at_marks[4]);  // after the last sample
}

TEST(Drift, MarkBeforeTheFirstSampleHasNoValue) {
  EXPECT_FALSE(drift_at({{5, {1, 0, 0}}}, 4));
  EXPECT_TRUE(drift_at({{5, {1, 0, 0}}}, 5.001));
  EXPECT_FALSE(drift_at({}, 5));
}

TEST(Drift, NotANumberIsInfinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const OutageDrift d =
      outage_drift(kOutage, {{1, {1, 1, 1}}, {2, {nan, 0, 0}}, {3, {1, 1, 1}}}, {});
  EXPECT_TRUE(std::isinf(d.maximum.horizontal));
  EXPECT_EQ(d.maximum.vertical, 1);
}

TEST(DriftCollector, GroupsByOutage) {
  DriftCollector collector;
  EXPECT_TRUE(collector.empty());
  const Outage next{4, kBegin + 150 * kNanosecondsPerSecond, kBegin + 210 * kNanosecondsPerSecond};
  for (int t = 1; t <= 60; ++t) collector.add(kOutage, after_begin(t), {0.01 * t * t, 0, 0.1 * t});
  for (int t = 1; t <= 60; ++t) collector.add(next, after_begin(150 + t), {0, 1.0 * t, 0});
  const std::vector<OutageDrift> drifts = collector.complete(after_begin(300));
  ASSERT_EQ(drifts.size(), 2u);
  EXPECT_EQ(drifts[0].outage.index, 3);
  EXPECT_NEAR(drifts[0].maximum.horizontal, 36, 1e-12);
  EXPECT_NEAR(drifts[0].maximum.vertical, 6, 1e-12);
  EXPECT_NEAR(drifts[0].at_marks[1]->horizontal, 4, 1e-12);  // at 20 s
  EXPECT_EQ(drifts[1].maximum.horizontal, 60);
  EXPECT_EQ(drifts[1].samples.size(), 60u);
}

TEST(DriftCollector, LeavesOutIncompleteOutages) {
  DriftCollector collector;
  for (int t = 1; t <= 59; ++t) collector.add(kOutage, after_begin(t), {1, 0, 0});
  EXPECT_EQ(collector.complete(after_begin(59)).size(), 0u);  // the recording ends within it
  EXPECT_EQ(collector.complete(after_begin(60)).size(), 1u);

  DriftCollector with_hole;
  for (int t = 1; t <= 40; ++t) with_hole.add(kOutage, after_begin(t), {1, 0, 0});
  EXPECT_EQ(with_hole.complete(after_begin(100)).size(), 0u);
}

GnssFix fix_at_home(const Eigen::Vector3d& p_b_a) {
  GnssFix fix;
  fix.p_b_a = p_b_a;
  fix.antenna = kHome;
  return fix;
}

TEST(FixError, IsThatOfTheAntenna) {
  state::Epoch epoch;
  epoch.position = kHome;
  epoch.q_n_b = so3::from_euler({0, 0, kPi / 2});  // forward is east, right is south
  const FixError error = fix_error(epoch, fix_at_home({1, 2, -3}), {});
  EXPECT_LT((error.error_n - Eigen::Vector3d(-2, 1, -3)).norm(), 1e-8);
}

/// With the lever arm and the clocks that were found.
TEST(FixError, IsThatOfTheAntennaAsItWasFound) {
  state::Layout layout;
  layout.add(state::block::time_offset, 1).add(state::block::time_drift, 1);
  layout.add(state::block::lever_arm, 1);
  state::Epoch epoch;
  epoch.position = kHome;
  epoch.velocity_n = {10, 0, 0};
  epoch.q_n_b = so3::from_euler({0, 0, kPi / 2});
  epoch.slow = state::SlowVector::Zero(5);
  epoch.slow << 0.1, 1e-3, 0.5, 0, 0;
  epoch.covariance = state::StateMatrix::Zero(20, 20);
  epoch.covariance.diagonal().tail<5>() << 0.01, 0, 0, 0, 0.04;
  GnssFix fix = fix_at_home({1, 2, -3});
  fix.since_first_s = 100;  // the fix is 0.2 s old, 2 m south
  const FixError error = fix_error(epoch, fix, layout);
  EXPECT_LT((error.error_n - Eigen::Vector3d(-4, 1.5, -3)).norm(), 1e-6);
  const Eigen::Matrix3d expected = Eigen::Vector3d(1, 0, 0.04).asDiagonal();
  EXPECT_LT((error.covariance_n - expected).norm(), 1e-9);
}

TEST(FixError, CovarianceIsThatOfSmallErrors) {
  state::Epoch epoch;
  epoch.position = kHome;
  epoch.q_n_b = so3::from_euler({0.1, -0.2, 0.7});
  const GnssFix fix = fix_at_home({1, 2, -3});
  // Columns: errors of one sigma each, correlated; their outer products are the covariance.
  Eigen::Matrix<double, 15, 6> errors = Eigen::Matrix<double, 15, 6>::Random() * 1e-3;
  epoch.covariance = errors * errors.transpose();
  const FixError estimate = fix_error(epoch, fix, {});
  Eigen::Matrix<double, 3, 6> moved;
  for (int i = 0; i < 6; ++i) {
    state::Epoch other = epoch;
    other.position = geodesy::LocalFrame(kHome).to_geodetic(errors.col(i).segment<3>(0));
    other.q_n_b = epoch.q_n_b * so3::exp(Eigen::Vector3d(errors.col(i).segment<3>(6)));
    moved.col(i) = fix_error(other, fix, {}).error_n - estimate.error_n;
  }
  const Eigen::Matrix3d expected = moved * moved.transpose();
  // Of second order in errors of 2 mrad.
  EXPECT_LT((estimate.covariance_n - expected).norm(), 4e-3 * expected.norm());
}

TEST(NormalizedSquares, ArePerDegreeOfFreedom) {
  Eigen::Matrix3d covariance;
  covariance << 4, 1, 0, 1, 2, 0, 0, 0, 9;
  const NormalizedSquares squares = normalized_squares({2, 1, -6}, covariance);
  // [2 1] [4 1; 1 2]^-1 [2 1]' = (2 * 4 - 2 * 2 + 4) / 7
  EXPECT_NEAR(squares.horizontal, 8.0 / 7 / 2, 1e-14);
  EXPECT_NEAR(squares.vertical, 4, 1e-14);
}

TEST(NormalizedSquares, ADivergedEstimateIsInfiniteAndOneWithoutSigmasNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(normalized_squares({nan, 0, 0}, Eigen::Matrix3d::Identity()).horizontal));
  EXPECT_TRUE(std::isinf(normalized_squares({0, 0, 0}, Eigen::Matrix3d::Constant(nan)).vertical));
  const NormalizedSquares none = normalized_squares({1, 1, 1}, Eigen::Matrix3d::Zero());
  EXPECT_TRUE(std::isnan(none.horizontal));
  EXPECT_TRUE(std::isnan(none.vertical));
}

TEST(SampleNear, IsTheNearestWithinASecond) {
  const std::vector<DriftSample> samples{{1, {1, 0, 0}}, {2, {2, 0, 0}}, {8, {8, 0, 0}}};
  EXPECT_EQ(sample_near(samples, 1.6), &samples[1]);
  EXPECT_EQ(sample_near(samples, 9), &samples[2]);
  EXPECT_EQ(sample_near(samples, 5), nullptr);
  EXPECT_EQ(sample_near({}, 5), nullptr);
}

TEST(FixTruth, ComparesAtTheAntenna) {
  std::vector<Eigen::Vector3d> errors;
  FixTruth truth(
      [&](const Outage& outage, const GnssFix& fix, const state::Epoch& at, const FixError& error) {
        EXPECT_EQ(outage.index, kOutage.index);
        EXPECT_EQ(fix.t_ns, after_begin(2));
        EXPECT_EQ(at.t_ns, after_begin(2));
        errors.push_back(error.error_n);
      });
  for (int t = 1; t <= 3; ++t) {
    GnssFix fix;
    fix.t_ns = after_begin(t);
    fix.p_b_a = {0, 0, -2};
    fix.antenna = kHome;
    truth.add(kOutage, fix);
  }
  state::Epoch epoch;  // 2 m below the antenna, and off by (0.3, -0.4, 0.1)
  epoch.position = geodesy::LocalFrame(kHome).to_geodetic({0.3, -0.4, 2.1});
  for (const double t : {0.5, 1.5, 2.0, 2.5}) {
    epoch.t_ns = after_begin(t);
    truth.epoch(epoch);
  }
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_LT((errors[0] - Eigen::Vector3d(0.3, -0.4, 0.1)).norm(), 1e-6);
}

}  // namespace
}  // namespace foucault::evaluation
