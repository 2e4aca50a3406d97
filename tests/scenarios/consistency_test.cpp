/// Normalized estimation errors over seeded runs: trajectory, sensor errors, fixes and alignment
/// are drawn anew for each, and the error of one epoch is measured by the covariance given with it.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/ekf/ekf.h"
#include "foucault/ekf/rts.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/navigation/smoother.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr int kRuns = 50;

constexpr double kDuration = 160;
/// Forward methods are asked at the end; a smoother has most to say before it.
constexpr double kSmootherAsked = 110;

/// Keeps the last epoch up to a stamp.
class EpochAt : public state::Sink {
 public:
  explicit EpochAt(int64_t until_ns) : until_ns_(until_ns) {}
  void epoch(const state::Epoch& epoch) override {
    if (epoch.t_ns <= until_ns_) last = epoch;
  }
  state::Epoch last;

 private:
  int64_t until_ns_;
};

/// Squared by their covariance, and the squared distance.
struct NormalizedErrors {
  double position = 0, velocity = 0, attitude = 0;
  double metres = 0;
};

NormalizedErrors normalized_errors(const state::Epoch& estimate, const state::Epoch& truth) {
  const Eigen::Vector3d attitude = so3::log(estimate.q_n_b.conjugate() * truth.q_n_b);
  const Eigen::Vector3d position = geodesy::ned_offset(estimate.position, truth.position);
  const Eigen::Vector3d velocity = truth.velocity_n - estimate.velocity_n;
  return {evaluation::normalized_square(position, estimate.covariance_of(state::block::position))
              .value(),
          evaluation::normalized_square(velocity, estimate.covariance_of(state::block::velocity))
              .value(),
          evaluation::normalized_square(attitude, estimate.covariance_of(state::block::attitude))
              .value(),
          position.squaredNorm()};
}

std::unique_ptr<state::Estimator> make_estimator(const std::string& method,
                                                 const imu::ImuNoise& noise,
                                                 const navigation::NavigationRunOptions& options,
                                                 const state::Mounting& mounting,
                                                 state::Sink& sink) {
  alignment::Aligner aligner(alignment::AlignmentOptions{}, noise, mounting);
  if (method == "rts")
    return navigation::make_smoother(
        std::make_unique<ekf::RtsRecorder>(noise, state::Layout{}, ekf::EkfOptions{}),
        std::move(aligner), options, sink);
  auto ekf = std::make_unique<ekf::EkfNavigator>(noise, state::Layout{}, ekf::EkfOptions{});
  if (method == "batch")
    return navigation::make_smoother(
        std::make_unique<fgo::BatchRecorder>(std::move(ekf), fgo::FgoOptions{},
                                             preintegration::PreintegrationModel::full, noise),
        std::move(aligner), options, sink);
  std::unique_ptr<measurement::Navigator> navigator = std::move(ekf);
  if (method == "full" || method == "refined") {
    const preintegration::PreintegrationModel model =
        method == "full" ? preintegration::PreintegrationModel::full
                         : preintegration::PreintegrationModel::refined;
    navigator = std::make_unique<fgo::WindowNavigator>(fgo::FgoOptions{}, model, noise);
  }
  return std::make_unique<navigation::NavigationRun>(std::move(navigator), std::move(aligner),
                                                     options, sink);
}

/// What is simulated, and what is used of it.
struct Experiment {
  simulation::ScenarioOptions scenario;
  navigation::NavigationRunOptions options;
};

NormalizedErrors run(const std::string& method, Experiment experiment, int seed) {
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  simulation::ScenarioOptions& scenario = experiment.scenario;
  scenario.seed = seed;
  scenario.duration_s = kDuration;
  simulation::SimulatedSource source(scenario, noise);
  const bool smoother = method == "rts" || method == "batch";
  EpochAt sink(scenario.start_ns() + nanoseconds(smoother ? kSmootherAsked : kDuration));
  const std::unique_ptr<state::Estimator> estimator =
      make_estimator(method, noise, experiment.options, source.mounting(), sink);
  while (const std::optional<Measurement> measurement = source.next())
    estimator->process(*measurement);
  estimator->finish();
  return normalized_errors(sink.last, source.truth(sink.last.t_ns));
}

NormalizedErrors mean_of_runs(const std::string& method, const Experiment& experiment = {}) {
  NormalizedErrors mean;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const NormalizedErrors errors = run(method, experiment, seed);
    mean.position += errors.position / kRuns;
    mean.velocity += errors.velocity / kRuns;
    mean.attitude += errors.attitude / kRuns;
    mean.metres += errors.metres / kRuns;
  }
  ::testing::Test::RecordProperty("position", std::to_string(mean.position));
  ::testing::Test::RecordProperty("velocity", std::to_string(mean.velocity));
  ::testing::Test::RecordProperty("attitude", std::to_string(mean.attitude));
  return mean;
}

void expect_in_band(double nees) {
  const Band band = evaluation::mean_nees_band(3, kRuns);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

class Consistency : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Consistency,
                         ::testing::Values("ekf", "refined", "full", "rts", "batch"));

TEST_P(Consistency, MeanNeesOfFiftyRunsLiesInItsBand) {
  const NormalizedErrors mean = mean_of_runs(GetParam());
  expect_in_band(mean.position);
  expect_in_band(mean.velocity);
  expect_in_band(mean.attitude);
}

/// Positions of a metre, velocities of 5 cm/s.
TEST_P(Consistency, VelocitiesHelpAndKeepTheBand) {
  Experiment experiment;
  experiment.scenario.gnss_sigma_m = {1, 1, 1};
  experiment.scenario.gnss_velocity_sigma_m_s = 0.05;
  const NormalizedErrors without = mean_of_runs(GetParam(), experiment);
  experiment.options.aids.gnss_velocity = "on";
  const NormalizedErrors with = mean_of_runs(GetParam(), experiment);
  EXPECT_LT(std::sqrt(with.metres), 0.9 * std::sqrt(without.metres));
  expect_in_band(with.position);
  expect_in_band(with.velocity);
  expect_in_band(with.attitude);
  std::printf("%s: %.3f m without, %.3f m with velocities; NEES %.2f %.2f %.2f\n", GetParam(),
              std::sqrt(without.metres), std::sqrt(with.metres), with.position, with.velocity,
              with.attitude);
}

}  // namespace
}  // namespace foucault
