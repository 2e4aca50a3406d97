/// Smoothers over simulated outages: two routes to one answer, and better than any forward run.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "foucault/ekf/rts.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/navigation/smoother.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

using Maker = std::function<std::unique_ptr<state::Estimator>(const imu::ImuNoise&,
                                                              alignment::Aligner, state::Sink&)>;

std::unique_ptr<measurement::Navigator> filter(const imu::ImuNoise& noise) {
  return std::make_unique<ekf::EkfNavigator>(noise, state::Layout{}, ekf::EkfOptions{});
}

std::unique_ptr<measurement::Navigator> window(preintegration::PreintegrationModel model,
                                               const imu::ImuNoise& noise) {
  return std::make_unique<fgo::WindowNavigator>(fgo::FgoOptions{}, model, noise);
}

Maker forward(const std::string& method) {
  return [method](const imu::ImuNoise& noise, alignment::Aligner aligner, state::Sink& sink) {
    return std::make_unique<navigation::NavigationRun>(
        method == "ekf" ? filter(noise) : window(preintegration::PreintegrationModel::full, noise),
        std::move(aligner), navigation::NavigationRunOptions{}, sink);
  };
}

Maker batch(preintegration::PreintegrationModel model, bool from_window) {
  return [=](const imu::ImuNoise& noise, alignment::Aligner aligner, state::Sink& sink) {
    return navigation::make_smoother(
        std::make_unique<fgo::BatchRecorder>(from_window ? window(model, noise) : filter(noise),
                                             fgo::FgoOptions{}, model, noise),
        std::move(aligner), {}, sink);
  };
}

std::unique_ptr<state::Estimator> rts(const imu::ImuNoise& noise, alignment::Aligner aligner,
                                      state::Sink& sink) {
  return navigation::make_smoother(
      std::make_unique<ekf::RtsRecorder>(noise, state::Layout{}, ekf::EkfOptions{}),
      std::move(aligner), {}, sink);
}

/// RMS of the outages' maximum horizontal errors [m].
double drift(const Maker& make) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 900;
  scenario.seed = 9;
  evaluation::OutageOptions options;
  options.first_s = 200;
  options.period_s = 130;
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  const evaluation::EstimatorFactory factory = [&](const state::Mounting& mounting,
                                                   state::Sink& sink) {
    return make(noise, alignment::Aligner(alignment::AlignmentOptions{}, noise, mounting), sink);
  };
  const evaluation::OutageRunResult result =
      evaluation::run_with_outages(std::make_unique<simulation::SimulatedSource>(scenario, noise),
                                   evaluation::OutageSchedule(options, 0), factory);
  std::vector<double> maxima;
  for (const evaluation::OutageDrift& outage : result.drifts)
    maxima.push_back(outage.maximum.horizontal);
  EXPECT_GE(maxima.size(), 5u);
  return evaluation::root_mean_square(maxima);
}

TEST(Smoothing, BatchAndRtsAgreeAndBeatTheForwardRunsFiveTimes) {
  const double best_forward = std::min(drift(forward("ekf")), drift(forward("full")));
  const double filtered_twice = drift(rts);
  const double optimized = drift(batch(preintegration::PreintegrationModel::full, false));
  EXPECT_GT(best_forward, 2);
  EXPECT_LT(filtered_twice, best_forward / 5);
  EXPECT_LT(optimized, best_forward / 5);
  EXPECT_NEAR(optimized, filtered_twice, 0.03 * filtered_twice);
}

TEST(Smoothing, TheBatchForgetsWhereItStarted) {
  const double from_filter = drift(batch(preintegration::PreintegrationModel::full, false));
  const double from_window = drift(batch(preintegration::PreintegrationModel::full, true));
  // The decay of the biases refers to the forward run's: 1e-4 of them in an outage.
  EXPECT_NEAR(from_window, from_filter, 0.002 * from_filter);
  // With the Earth at rest the optimum is another one: the model matters, not the smoothing alone.
  EXPECT_GT(drift(batch(preintegration::PreintegrationModel::rough, false)), 1.5 * from_filter);
}

}  // namespace
}  // namespace foucault
