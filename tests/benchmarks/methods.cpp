#include "methods.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "best_times.h"
#include "foucault/core/profile.h"
#include "foucault/ekf/ekf.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/navigation/smoother.h"
#include "trip.h"

namespace foucault::benchmarks {
namespace {

constexpr double kDuration = 400;  // [s]

class EpochCounter : public state::Sink {
 public:
  void epoch(const state::Epoch&) override { ++epochs; }
  int64_t epochs = 0;
};

alignment::Aligner aligner(const Trip& trip) {
  return alignment::Aligner(alignment::AlignmentOptions{}, trip.noise, trip.mounting);
}

void process(const Trip& trip, state::Estimator& estimator) {
  for (const Measurement& measurement : trip.measurements) estimator.process(measurement);
  estimator.finish();
}

double seconds(const std::vector<StageTime>& times, std::initializer_list<Stage> stages) {
  double sum = 0;
  for (const StageTime& time : times) {
    if (std::find(stages.begin(), stages.end(), time.stage) != stages.end()) sum += time.seconds;
  }
  return sum;
}

void window(benchmark::State& state, double gnss_rate_hz) {
  const Trip trip = simulated_trip(kDuration, gnss_rate_hz);
  EpochCounter counter;
  for ([[maybe_unused]] const auto _ : state) {
    counter.epochs = 0;
    navigation::NavigationRun run(
        std::make_unique<fgo::WindowNavigator>(
            fgo::FgoOptions{}, preintegration::PreintegrationModel::refined, trip.noise),
        aligner(trip), navigation::NavigationRunOptions{}, counter);
    Profile profile;
    process(trip, run);
    state.SetIterationTime(
        seconds(profile.times(), {Stage::solve, Stage::marginalize, Stage::covariance}));
  }
  state.counters[kThings] = static_cast<double>(counter.epochs);
}

void ekf(benchmark::State& state) {
  const Trip trip = simulated_trip(kDuration, 1);
  EpochCounter counter;
  for ([[maybe_unused]] const auto _ : state) {
    navigation::NavigationRun run(
        std::make_unique<ekf::EkfNavigator>(trip.noise, state::Layout{}, ekf::EkfOptions{}),
        aligner(trip), navigation::NavigationRunOptions{}, counter);
    process(trip, run);
  }
  state.counters[kThings] = static_cast<double>(trip.samples);
}

void batch(benchmark::State& state) {
  const Trip trip = simulated_trip(kDuration, 1);
  EpochCounter counter;
  for ([[maybe_unused]] const auto _ : state) {
    counter.epochs = 0;
    const std::unique_ptr<state::Estimator> smoother = navigation::make_smoother(
        std::make_unique<fgo::BatchRecorder>(
            std::make_unique<ekf::EkfNavigator>(trip.noise, state::Layout{}, ekf::EkfOptions{}),
            fgo::FgoOptions{}, preintegration::PreintegrationModel::full, trip.noise),
        aligner(trip), navigation::NavigationRunOptions{}, counter);
    for (const Measurement& measurement : trip.measurements) smoother->process(measurement);
    Profile profile;
    smoother->finish();
    state.SetIterationTime(
        seconds(profile.times(), {Stage::solve, Stage::covariance, Stage::smooth}));
  }
  state.counters[kThings] = static_cast<double>(counter.epochs);
}

}  // namespace

void register_methods() {
  add("window/1 Hz", window, 1.0)->UseManualTime();
  add("window/10 Hz", window, 10.0)->UseManualTime();
  add("ekf", ekf);
  add("batch", batch)->UseManualTime();
}

}  // namespace foucault::benchmarks
