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

using Maker = std::function<std::unique_ptr<Estimator>(const ImuNoise&, Aligner, Sink&)>;

std::unique_ptr<Navigator> filter(const ImuNoise& noise) {
  return std::make_unique<EkfNavigator>(noise, Layout{}, EkfOptions{});
}

std::unique_ptr<Navigator> window(PreintegrationModel model, const ImuNoise& noise) {
  return std::make_unique<WindowNavigator>(FgoOptions{}, model, noise);
}

Maker forward(const std::string& method) {
  return [method](const ImuNoise& noise, Aligner aligner, Sink& sink) {
    return std::make_unique<NavigationRun>(
        method == "ekf" ? filter(noise) : window(PreintegrationModel::full, noise),
        std::move(aligner), NavigationRunOptions{}, sink);
  };
}

Maker batch(PreintegrationModel model, bool from_window) {
  return [=](const ImuNoise& noise, Aligner aligner, Sink& sink) {
    return make_smoother(
        std::make_unique<BatchRecorder>(from_window ? window(model, noise) : filter(noise),
                                        FgoOptions{}, model, noise),
        std::move(aligner), {}, sink);
  };
}

std::unique_ptr<Estimator> rts(const ImuNoise& noise, Aligner aligner, Sink& sink) {
  return make_smoother(std::make_unique<RtsRecorder>(noise, Layout{}, EkfOptions{}),
                       std::move(aligner), {}, sink);
}

/// RMS of the outages' maximum horizontal errors [m].
double drift(const Maker& make) {
  ScenarioOptions scenario;
  scenario.duration_s = 900;
  scenario.seed = 9;
  OutageOptions options;
  options.first_s = 200;
  options.period_s = 130;
  const ImuNoise noise = imu_preset("ADIS16465");
  const EstimatorFactory factory = [&](const Mounting& mounting, Sink& sink) {
    return make(noise, Aligner(AlignmentOptions{}, noise, mounting), sink);
  };
  const OutageRunResult result = run_with_outages(
      std::make_unique<SimulatedSource>(scenario, noise), OutageSchedule(options, 0), factory);
  std::vector<double> maxima;
  for (const OutageDrift& outage : result.drifts) maxima.push_back(outage.maximum.horizontal);
  EXPECT_GE(maxima.size(), 5u);
  return root_mean_square(maxima);
}

TEST(Smoothing, BatchAndRtsAgreeAndBeatTheForwardRunsFiveTimes) {
  const double best_forward = std::min(drift(forward("ekf")), drift(forward("full")));
  const double filtered_twice = drift(rts);
  const double optimized = drift(batch(PreintegrationModel::full, false));
  EXPECT_GT(best_forward, 2);
  EXPECT_LT(filtered_twice, best_forward / 5);
  EXPECT_LT(optimized, best_forward / 5);
  EXPECT_NEAR(optimized, filtered_twice, 0.03 * filtered_twice);
}

TEST(Smoothing, TheBatchForgetsWhereItStarted) {
  const double from_filter = drift(batch(PreintegrationModel::full, false));
  const double from_window = drift(batch(PreintegrationModel::full, true));
  // The decay of the biases refers to the forward run's: 1e-4 of them in an outage.
  EXPECT_NEAR(from_window, from_filter, 0.002 * from_filter);
  // With the Earth at rest the optimum is another one: the model matters, not the smoothing alone.
  EXPECT_GT(drift(batch(PreintegrationModel::rough, false)), 1.5 * from_filter);
}

}  // namespace
}  // namespace foucault
