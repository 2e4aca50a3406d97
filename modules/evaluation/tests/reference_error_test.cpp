#include "foucault/evaluation/reference_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::evaluation {
namespace {

const Geodetic kHome{48 * kDegree, 11 * kDegree, 500};

/// A vehicle on a circle: radius 100 m, 0.1 rad/s, so 10 m/s and 1 m/s^2; climbing at 1 m/s.
Eigen::Vector3d circle(double t) {
  return {100 * std::sin(0.1 * t), 100 - 100 * std::cos(0.1 * t), -t};
}

ReferencePose reference_at(double t, bool with_velocity = true, bool with_attitude = true) {
  const geodesy::LocalFrame frame(kHome);
  ReferencePose pose;
  pose.t_ns = nanoseconds(t);
  pose.position = frame.to_geodetic(circle(t));
  const Eigen::Vector3d v_w(10 * std::cos(0.1 * t), 10 * std::sin(0.1 * t), -1);
  if (with_velocity) pose.velocity_n = frame.R_w_n(pose.position).transpose() * v_w;
  if (with_attitude) pose.q_n_v = so3::from_euler({0.02, -0.01, 0.1 * t});
  return pose;
}

/// An epoch that errs by `offset_n` from the circle.
state::Epoch epoch_at(double t, const Eigen::Vector3d& offset_n = Eigen::Vector3d::Zero()) {
  const ReferencePose truth = reference_at(t);
  state::Epoch epoch;
  epoch.t_ns = truth.t_ns;
  epoch.position = geodesy::LocalFrame(truth.position).to_geodetic(offset_n);
  epoch.velocity_n = *truth.velocity_n;
  epoch.q_n_b = *truth.q_n_v;
  return epoch;
}

struct Recorder {
  std::vector<state::ReferenceError> errors;
  ReferenceComparison comparison;

  explicit Recorder(const ReferenceComparisonOptions& options = {})
      : comparison(
            state::Mounting(),
            [this](const state::Epoch& epoch, const state::ReferenceError& error) {
              EXPECT_EQ(epoch.t_ns, error.t_ns);
              errors.push_back(error);
            },
            options) {}
};

TEST(Interpolate, CubicFollowsACircle) {
  const ReferencePose a = reference_at(3);
  const ReferencePose b = reference_at(4);
  for (const double t : {3.0, 3.25, 3.5, 3.9, 4.0}) {
    const ReferencePose pose = interpolate(a, b, nanoseconds(t));
    const ReferencePose truth = reference_at(t);
    // Hermite's remainder: r omega^4 dt^4 / 384 = 26 um.
    EXPECT_LT(geodesy::ned_offset(truth.position, pose.position).norm(), 3e-5) << t;
    // Linear between: r omega^3 dt^2 / 8 = 12.5 mm/s.
    EXPECT_LT((*pose.velocity_n - *truth.velocity_n).norm(), 0.0126) << t;
    EXPECT_LT(so3::log(truth.q_n_v->conjugate() * *pose.q_n_v).norm(), 1e-14) << t;
    EXPECT_EQ(pose.t_ns, nanoseconds(t));
  }
}

TEST(Interpolate, LinearWithoutVelocity) {
  const ReferencePose pose =
      interpolate(reference_at(3, false), reference_at(4, true, false), nanoseconds(3.5));
  const double miss = geodesy::ned_offset(reference_at(3.5).position, pose.position).norm();
  EXPECT_NEAR(miss, 1.0 / 8, 1e-3);  // a dt^2 / 8
  EXPECT_FALSE(pose.velocity_n);
  EXPECT_FALSE(pose.q_n_v);
}

TEST(ReferenceError, IsEstimateMinusReference) {
  state::Epoch epoch = epoch_at(3, {1, -2, 0.5});
  epoch.velocity_n += Eigen::Vector3d(0.1, 0.2, -0.3);
  epoch.q_n_b = so3::from_euler({0.03, -0.03, 0.3 + 0.05});
  const state::ReferenceError error = reference_error(epoch, state::Mounting(), reference_at(3));
  // 1e-6: the horizon of the reference against that of the estimate.
  EXPECT_LT((error.position_n - Eigen::Vector3d(1, -2, 0.5)).norm(), 2e-6);
  EXPECT_LT((*error.velocity_n - Eigen::Vector3d(0.1, 0.2, -0.3)).norm(), 1e-14);
  EXPECT_LT((*error.euler - Eigen::Vector3d(0.01, -0.02, 0.05)).norm(), 1e-14);
}

TEST(ReferenceError, HeadingErrorIsWrapped) {
  ReferencePose reference = reference_at(0);
  reference.q_n_v = so3::from_euler({0, 0, 0.01});
  state::Epoch epoch = epoch_at(0);
  epoch.q_n_b = so3::from_euler({0, 0, -0.01});  // 6.27 rad
  EXPECT_NEAR((*reference_error(epoch, state::Mounting(), reference).euler)[2], -0.02, 1e-14);
}

TEST(ReferenceError, AttitudeIsTheVehicles) {
  state::Mounting mounting;
  mounting.q_v_b = so3::exp({0.5, 2, -1});
  state::Epoch epoch = epoch_at(3);
  epoch.q_n_b = epoch.q_n_b * mounting.q_v_b;
  EXPECT_LT(reference_error(epoch, mounting, reference_at(3)).euler->norm(), 1e-14);
}

TEST(ReferenceError, AFarEstimateHasNoFalseHeight) {
  const state::Epoch epoch = epoch_at(3);
  ReferencePose reference = reference_at(3);
  reference.position.latitude += 1e-3;  // 6.4 km, of which the horizon makes 3.2 m of height
  EXPECT_NEAR(reference_error(epoch, state::Mounting(), reference).position_n.z(), 0, 1e-9);
}

TEST(ReferenceComparison, ExactWhereStampsMatch) {
  Recorder r;
  // Without velocity and 1 s apart nothing could be interpolated.
  for (int t = 0; t < 5; ++t) {
    r.comparison.add(reference_at(t, false, false));
    r.comparison.add(epoch_at(t, {0.1 * t, 0, 0}));
  }
  ASSERT_EQ(r.errors.size(), 5u);
  for (int t = 0; t < 5; ++t) {
    EXPECT_NEAR(r.errors[t].position_n.x(), 0.1 * t, 1e-8);
    EXPECT_FALSE(r.errors[t].velocity_n);
    EXPECT_FALSE(r.errors[t].euler);
  }
}

TEST(ReferenceComparison, EpochsMayComeBeforeTheirReference) {
  Recorder r;
  r.comparison.add(reference_at(0));
  for (const double t : {0.0, 0.25, 0.5, 0.75}) r.comparison.add(epoch_at(t));
  EXPECT_EQ(r.errors.size(), 1u);
  r.comparison.add(reference_at(1));
  ASSERT_EQ(r.errors.size(), 4u);
  for (const state::ReferenceError& e : r.errors) EXPECT_LT(e.position_n.norm(), 3e-5);
}

TEST(ReferenceComparison, EpochsMayComeMuchLater) {
  Recorder r;
  for (int t = 0; t <= 100; ++t) r.comparison.add(reference_at(t));
  for (int t = 10; t <= 100; ++t) r.comparison.add(epoch_at(t - 0.5));
  ASSERT_EQ(r.errors.size(), 91u);
  for (const state::ReferenceError& e : r.errors) EXPECT_LT(e.position_n.norm(), 3e-5);
}

TEST(ReferenceComparison, NothingAcrossAGap) {
  Recorder r;
  for (const double t : {0.0, 1.0, 2.5, 3.0}) r.comparison.add(reference_at(t));
  for (const double t : {0.5, 1.0, 1.5, 2.4, 2.5, 2.75}) r.comparison.add(epoch_at(t));
  std::vector<int64_t> stamps;
  for (const state::ReferenceError& e : r.errors) stamps.push_back(e.t_ns / 10'000'000);
  EXPECT_EQ(stamps, (std::vector<int64_t>{50, 100, 250, 275}));
}

TEST(ReferenceComparison, LinearOnlyOverShortIntervals) {
  Recorder r;
  for (const double t : {0.0, 0.1, 0.2, 0.7}) r.comparison.add(reference_at(t, false));
  for (const double t : {0.05, 0.15, 0.45}) r.comparison.add(epoch_at(t));
  EXPECT_EQ(r.errors.size(), 2u);
}

TEST(ReferenceComparison, NothingBeforeTheFirstReferenceOrAfterTheLast) {
  Recorder r;
  r.comparison.add(epoch_at(0));
  r.comparison.add(epoch_at(0.5));
  r.comparison.add(reference_at(1));
  r.comparison.add(reference_at(2));
  r.comparison.add(epoch_at(2));
  for (int t = 3; t < 10; ++t) r.comparison.add(epoch_at(t));
  ASSERT_EQ(r.errors.size(), 1u);
  EXPECT_EQ(r.errors[0].t_ns, nanoseconds(2));
}

TEST(ReferenceComparison, ForgetsReferencesThatAreTooOld) {
  Recorder r({1, 0.2, 10});
  for (int t = 0; t <= 100; ++t) r.comparison.add(reference_at(t));
  r.comparison.add(epoch_at(50));
  EXPECT_TRUE(r.errors.empty());
  r.comparison.add(epoch_at(95));
  EXPECT_EQ(r.errors.size(), 1u);
}

}  // namespace
}  // namespace foucault::evaluation
