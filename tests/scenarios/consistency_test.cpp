/// Normalized estimation errors over seeded runs: trajectory, sensor errors, fixes and alignment
/// are drawn anew for each, and the error at its end is measured by the covariance given with it.

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "foucault/core/so3.h"
#include "foucault/ekf/ekf.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/inertial/navigation_run.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr int kRuns = 50;

/// Keeps the last epoch.
class LastEpoch : public Sink {
 public:
  void epoch(const Epoch& epoch) override { last = epoch; }
  Epoch last;
};

struct NormalizedErrors {
  double position = 0, velocity = 0, attitude = 0;
};

Eigen::Matrix3d block(const Epoch& epoch, int row) {
  return epoch.covariance.block<3, 3>(row, row);
}

NormalizedErrors errors_at_the_end(const Epoch& estimate, const Epoch& truth) {
  const Eigen::Vector3d attitude = so3::log(estimate.q_n_b.conjugate() * truth.q_n_b);
  const Eigen::Vector3d position = ned_offset(estimate.position, truth.position);
  const Eigen::Vector3d velocity = truth.velocity_n - estimate.velocity_n;
  return {normalized_square(position, block(estimate, error_state::kPosition)).value(),
          normalized_square(velocity, block(estimate, error_state::kVelocity)).value(),
          normalized_square(attitude, block(estimate, error_state::kAttitude)).value()};
}

NormalizedErrors run(const std::string& method, int seed) {
  const ImuNoise noise = imu_preset("ADIS16465");
  ScenarioOptions scenario;
  scenario.seed = seed;
  scenario.duration_s = 160;
  SimulatedSource source(scenario, noise);
  std::unique_ptr<Navigator> navigator;
  if (method == "ekf") {
    navigator = std::make_unique<EkfNavigator>(noise, EkfOptions{});
  } else {
    const PreintegrationModel model =
        method == "full" ? PreintegrationModel::full : PreintegrationModel::refined;
    navigator = std::make_unique<WindowNavigator>(FgoOptions{}, model, noise);
  }
  LastEpoch sink;
  NavigationRun estimator(std::move(navigator),
                          Aligner(AlignmentOptions{}, noise, source.mounting()),
                          NavigationRunOptions{}, sink);
  while (const std::optional<Measurement> measurement = source.next())
    estimator.process(*measurement);
  estimator.finish();
  return errors_at_the_end(sink.last, source.truth(sink.last.t_ns));
}

NormalizedErrors mean_of_runs(const std::string& method) {
  NormalizedErrors mean;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const NormalizedErrors errors = run(method, seed);
    mean.position += errors.position / kRuns;
    mean.velocity += errors.velocity / kRuns;
    mean.attitude += errors.attitude / kRuns;
  }
  ::testing::Test::RecordProperty("position", std::to_string(mean.position));
  ::testing::Test::RecordProperty("velocity", std::to_string(mean.velocity));
  ::testing::Test::RecordProperty("attitude", std::to_string(mean.attitude));
  return mean;
}

void expect_in_band(double nees) {
  const Band band = mean_nees_band(3, kRuns);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

class Consistency : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Consistency, ::testing::Values("ekf", "refined", "full"));

TEST_P(Consistency, MeanNeesOfFiftyRunsLiesInItsBand) {
  const NormalizedErrors mean = mean_of_runs(GetParam());
  expect_in_band(mean.position);
  expect_in_band(mean.velocity);
  expect_in_band(mean.attitude);
}

}  // namespace
}  // namespace foucault
