#include "foucault/calibration/recorded_way.h"

#include <gtest/gtest.h>

#include <map>

#include "foucault/calibration/prediction.h"
#include "foucault/core/time.h"
#include "trip.h"

namespace foucault::calibration {
namespace {

struct Met {
  Eigen::Vector3d error;  ///< in sigmas that were told
  Eigen::Matrix3d covariance;
};

/// In sigmas of the fix.
Met in_sigmas(const state::Innovation& z, const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d L_inverse = Eigen::Matrix3d(R.llt().matrixL()).inverse();
  return {L_inverse * Eigen::Vector3d(z.value),
          L_inverse * Eigen::Matrix3d(z.covariance) * L_inverse.transpose()};
}

Eigen::Matrix3d covariance_of(const measurement::ObservationPtr& fix, const state::NavState& x,
                              const state::Layout& layout) {
  return fix->linearize(x, {}, layout).R;
}

/// Two routes: what the filter itself expects of each fix, and what its way gives, gone again with
/// the same noise. The filter's steps of 0.5 s are the same; nonlinear terms are all that differs.
TEST(RecordedWay, GoneAgainItMeetsFixesAsTheFilterDid) {
  Trip trip;
  trip.scenario.duration_s = 400;
  std::map<int64_t, Met> met;
  UnfoldedWay unfolded;
  ekf::EkfOptions options;
  options.cov_interval_s = 0.5;
  WayRecorder filter(trip.told, {}, options, unfolded);
  trip.drive(filter, [&](const measurement::ObservationPtr& fix) {
    met[filter.state().t_ns] =
        in_sigmas(filter.innovation(*fix), covariance_of(fix, filter.state(), {}));
    filter.update(fix);
  });
  const RecordedWay way = folded(unfolded, {});
  NoiseModel noise;
  noise.imu = trip.told;
  const std::vector<Prediction> found = predictions(way, noise, {{}, 0});
  ASSERT_GT(found.size(), 250u);
  for (const Prediction& p : found) {
    EXPECT_LT((p.error - met.at(p.t_ns).error).norm(), 0.02) << p.t_ns;
    EXPECT_LT((p.covariance - met.at(p.t_ns).covariance).norm() / p.covariance.norm(), 0.01);
  }
}

/// A minute ahead: the filter drives on without fixes; a way with five a second goes in legs.
class Ahead : public testing::TestWithParam<double> {};

TEST_P(Ahead, PredictsAMinuteAheadAsTheFilterDoes) {
  Trip trip;
  trip.scenario.duration_s = 300;
  trip.scenario.gnss_rate_hz = GetParam();
  UnfoldedWay unfolded;
  ekf::EkfOptions options;
  options.cov_interval_s = 0.5;
  WayRecorder filter(trip.told, {}, options, unfolded);
  ekf::EkfNavigator alone(trip.told, {}, options);
  const int64_t from_ns = trip.scenario.start_ns() + 200'050'000'000;
  std::map<int64_t, Met> met;
  trip.drive(filter, [&](const measurement::ObservationPtr& fix) { filter.update(fix); });
  trip.drive(alone, [&](const measurement::ObservationPtr& fix) {
    if (alone.state().t_ns < from_ns) return alone.update(fix);
    met[alone.state().t_ns] =
        in_sigmas(alone.innovation(*fix), covariance_of(fix, alone.state(), {}));
  });
  NoiseModel noise;
  noise.imu = trip.told;
  int compared = 0;
  for (const Prediction& p : predictions(folded(unfolded, {}), noise, {{5, 15, 30, 60}, 1})) {
    const auto same = met.find(p.t_ns);
    const double since = seconds_between(from_ns, p.t_ns);
    if (p.horizon_s == 0 || same == met.end() || std::abs(since - p.horizon_s) > 0.1) continue;
    ++compared;
    const double sigma = std::sqrt(p.covariance.trace());
    EXPECT_LT((p.error - same->second.error).norm(), 0.02 * sigma) << p.horizon_s;
    EXPECT_LT((p.covariance - same->second.covariance).norm(), 0.03 * p.covariance.norm());
  }
  EXPECT_GE(compared, 4);
}

INSTANTIATE_TEST_SUITE_P(Rates, Ahead, testing::Values(1.0, 5.0));

/// Slow blocks are an input: the way of a filter that still learns a lever arm is that of one that
/// knew it.
TEST(RecordedWay, SlowBlocksAreWhatTheyCameToBe) {
  Trip trip;
  trip.scenario.duration_s = 600;
  trip.scenario.lever_arm_error_m = {0.3, -0.2, 0};
  state::Layout layout;
  layout.add(state::block::lever_arm, 0.5);
  NoiseModel noise;
  noise.imu = trip.told;
  const auto size = [&](const RecordedWay& way) {
    return normalized_errors(predictions(way, noise, {{}, 0})).front().mean;
  };
  EXPECT_NEAR(size(trip.way(layout)), 1, 0.1);
  EXPECT_GT(size(trip.way()), 2);  // the negative control: nothing was learned
}

TEST(RecordedWay, IsEmptyIfARunEndsWithinAMinute) {
  Trip trip;
  trip.scenario.duration_s = 55;
  EXPECT_TRUE(trip.way().empty());
}

TEST(RecordedWay, RemembersWhatSigmasWereTold) {
  Trip trip;
  trip.scenario.duration_s = 120;
  trip.told_sigma_factor = 3;
  const RecordedWay way = trip.way();
  Trip other = trip;
  other.told_sigma_factor = 1;
  EXPECT_NEAR(told_sigma(way, NoiseOf::position)[0] / told_sigma(other.way(), NoiseOf::position)[0],
              3, 1e-9);
  EXPECT_EQ(told_sigma(way, NoiseOf::wheel), Eigen::Vector3d::Zero());
  EXPECT_NEAR(length_s(way), 60, 2);
}

}  // namespace
}  // namespace foucault::calibration
