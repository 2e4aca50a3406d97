/// Errors in outages over the sigmas that the methods gave for them, pooled over simulated trips:
/// trajectory, sensor errors, fixes and alignment are drawn anew for each.

#include "foucault/evaluation/outage_consistency.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "foucault/ekf/ekf.h"
#include "foucault/ekf/rts_smoother.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/inertial/navigation_run.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr int kTrips = 3;

std::unique_ptr<Estimator> make_estimator(const std::string& method, const ImuNoise& noise,
                                          const Mounting& mounting, Sink& sink) {
  Aligner aligner(AlignmentOptions{}, noise, mounting);
  if (method == "rts") return make_rts_smoother(noise, EkfOptions{}, std::move(aligner), {}, sink);
  return std::make_unique<NavigationRun>(std::make_unique<EkfNavigator>(noise, EkfOptions{}),
                                         std::move(aligner), NavigationRunOptions{}, sink);
}

/// Six outages of 60 s. `assumed`: what the method takes for the noise of its ADIS16465.
ExperimentResult trip(const std::string& method, int seed, const ImuNoise& assumed) {
  ScenarioOptions scenario;
  scenario.duration_s = 840;
  scenario.seed = seed;
  OutageOptions options;
  options.first_s = 200;
  options.period_s = 110;
  ExperimentResult result;
  result.method = method;
  result.shift_s = seed;  // makes the outages of each trip their own
  result.run =
      run_with_outages(std::make_unique<SimulatedSource>(scenario, imu_preset("ADIS16465")),
                       OutageSchedule(options, 0), [&](const Mounting& mounting, Sink& sink) {
                         return make_estimator(method, assumed, mounting, sink);
                       });
  return result;
}

std::vector<NormalizedDrift> normalized(const std::string& method, const ImuNoise& assumed) {
  std::vector<ExperimentResult> trips;
  for (int seed = 1; seed <= kTrips; ++seed) trips.push_back(trip(method, seed, assumed));
  return normalized_drifts(group_outages(trips, Grouping::all)).at(0).times;
}

void expect_in_band(const PooledSquares& squares, const NormalizedDrift& drift) {
  EXPECT_EQ(squares.outages, 6 * kTrips);
  EXPECT_GT(squares.mean, squares.band.low) << time_text(drift);
  EXPECT_LT(squares.mean, squares.band.high) << time_text(drift);
}

class OutageConsistency : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, OutageConsistency, ::testing::Values("ekf", "rts"));

TEST_P(OutageConsistency, NormalizedDriftLiesInItsBands) {
  const std::vector<NormalizedDrift> drifts = normalized(GetParam(), imu_preset("ADIS16465"));
  ASSERT_EQ(drifts.size(), 5u);  // 5, 15, 30, 60 s and the middle
  for (const NormalizedDrift& drift : drifts) {
    expect_in_band(drift.horizontal, drift);
    expect_in_band(drift.vertical, drift);
  }
}

/// White noise taken for half of what it is: at the rate of the fixes hardly seen, after a minute
/// plainly.
TEST(OutageConsistencyOf, AnOptimisticNoiseModelLeavesTheBandUpwards) {
  ImuNoise assumed = imu_preset("ADIS16465");
  assumed.gyro_noise_density /= 2;
  assumed.accel_noise_density /= 2;
  const NormalizedDrift last = normalized("ekf", assumed).at(3);
  EXPECT_EQ(last.after_s, 60);
  EXPECT_GT(last.horizontal.mean, last.horizontal.band.high);
}

}  // namespace
}  // namespace foucault
