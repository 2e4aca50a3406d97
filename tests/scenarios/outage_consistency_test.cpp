/// Errors in outages over the sigmas that the methods gave for them, pooled over simulated trips:
/// trajectory, sensor errors, fixes and alignment are drawn anew for each.

#include "foucault/evaluation/outage_consistency.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "foucault/ekf/ekf.h"
#include "foucault/ekf/rts.h"
#include "foucault/evaluation/outage_join.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/navigation/smoother.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr int kTrips = 3;

std::unique_ptr<state::Estimator> make_estimator(const std::string& method,
                                                 const imu::ImuNoise& noise,
                                                 const state::Mounting& mounting,
                                                 state::Sink& sink) {
  alignment::Aligner aligner(alignment::AlignmentOptions{}, noise, mounting);
  if (method == "rts")
    return navigation::make_smoother(
        std::make_unique<ekf::RtsRecorder>(noise, state::Layout{}, ekf::EkfOptions{}),
        std::move(aligner), {}, sink);
  return std::make_unique<navigation::NavigationRun>(
      std::make_unique<ekf::EkfNavigator>(noise, state::Layout{}, ekf::EkfOptions{}),
      std::move(aligner), navigation::NavigationRunOptions{}, sink);
}

/// Six outages of 60 s. `assumed`: what the method takes for the noise of its ADIS16465.
evaluation::ExperimentResult trip(const std::string& method, int seed,
                                  const imu::ImuNoise& assumed) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 840;
  scenario.seed = seed;
  evaluation::OutageOptions outages;
  outages.first_s = 200;
  outages.period_s = 110;
  evaluation::OutageRunOptions run_options;
  run_options.reference.keep_s = scenario.duration_s;  // a smoother's epochs come at the end
  evaluation::ExperimentResult result;
  result.method = method;
  result.shift_s = seed;  // makes the outages of each trip their own
  const evaluation::EstimatorFactory factory = [&](const state::Mounting& mounting,
                                                   state::Sink& sink) {
    return make_estimator(method, assumed, mounting, sink);
  };
  result.run = evaluation::run_with_outages(
      std::make_unique<simulation::SimulatedSource>(scenario, imu::imu_preset("ADIS16465")),
      evaluation::OutageSchedule(outages, 0), factory, run_options);
  return result;
}

std::vector<evaluation::NormalizedDrift> normalized(const std::string& method,
                                                    const imu::ImuNoise& assumed) {
  std::vector<evaluation::ExperimentResult> trips;
  for (int seed = 1; seed <= kTrips; ++seed) trips.push_back(trip(method, seed, assumed));
  return evaluation::normalized_drifts(evaluation::group_outages(trips, evaluation::Grouping::all))
      .at(0)
      .times;
}

/// Of twenty means in their bands all are with 98 %.
Band band(const evaluation::PooledSquares& squares, int dof) {
  const Band of_sum = evaluation::mean_nees_band(dof, static_cast<double>(squares.outages), 0.999);
  return {of_sum.low / dof, of_sum.high / dof};
}

void expect_in_band(const evaluation::PooledSquares& squares, int dof,
                    const evaluation::NormalizedDrift& drift) {
  EXPECT_EQ(squares.outages, 6 * kTrips);
  EXPECT_GT(squares.mean, band(squares, dof).low) << evaluation::time_text(drift);
  EXPECT_LT(squares.mean, band(squares, dof).high) << evaluation::time_text(drift);
}

class OutageConsistency : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, OutageConsistency, ::testing::Values("ekf", "rts"));

TEST_P(OutageConsistency, NormalizedDriftLiesInItsBands) {
  const std::vector<evaluation::NormalizedDrift> drifts =
      normalized(GetParam(), imu::imu_preset("ADIS16465"));
  ASSERT_EQ(drifts.size(), 5u);  // 5, 15, 30, 60 s and the middle
  for (const evaluation::NormalizedDrift& drift : drifts) {
    expect_in_band(drift.horizontal, 2, drift);
    expect_in_band(drift.vertical, 1, drift);
  }
}

/// White noise taken for half of what it is: at the rate of the fixes hardly seen, after a minute
/// plainly.
TEST(OutageConsistencyOf, AnOptimisticNoiseModelLeavesTheBandUpwards) {
  imu::ImuNoise assumed = imu::imu_preset("ADIS16465");
  assumed.gyro_noise_density /= 2;
  assumed.accel_noise_density /= 2;
  const evaluation::NormalizedDrift last = normalized("ekf", assumed).at(3);
  EXPECT_EQ(last.after_s, 60);
  EXPECT_GT(last.horizontal.mean, band(last.horizontal, 2).high);
}

}  // namespace
}  // namespace foucault
