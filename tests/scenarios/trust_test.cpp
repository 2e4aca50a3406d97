/// Which runs are believed: simulated trips as they are and with what other people's recordings
/// have.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/simulation/faults.h"
#include "foucault/simulation/simulated_source.h"
#include "methods.h"
#include "settings.h"

namespace foucault::app {
namespace {

using Change = std::function<void(ImuIncrement&)>;

/// A recording with other increments.
class ChangedImu : public state::Source {
 public:
  ChangedImu(std::unique_ptr<state::Source> source, Change change)
      : source_(std::move(source)), change_(std::move(change)) {}

  std::optional<Measurement> next() override {
    std::optional<Measurement> measurement = source_->next();
    if (!measurement) return measurement;
    if (auto* increment = std::get_if<ImuIncrement>(&*measurement)) change_(*increment);
    return measurement;
  }
  const state::Mounting& mounting() const override { return source_->mounting(); }
  double progress() const override { return source_->progress(); }

 private:
  std::unique_ptr<state::Source> source_;
  Change change_;
};

constexpr double kThroughout = std::numeric_limits<double>::infinity();

/// A city trip with RTK at 1 Hz.
std::unique_ptr<state::Source> trip(int64_t seed = 1,
                                    const imu::ImuNoise& noise = imu::imu_preset("ADIS16465")) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 300;
  scenario.imu_rate_hz = 100;
  scenario.seed = seed;
  return std::make_unique<simulation::SimulatedSource>(scenario, noise);
}

std::unique_ptr<state::Source> with_fault(const simulation::Fault& fault, int64_t seed = 1) {
  return std::make_unique<simulation::FaultySource>(trip(seed),
                                                    std::vector<simulation::Fault>{fault}, seed);
}

std::unique_ptr<state::Source> with_imu(Change change) {
  return std::make_unique<ChangedImu>(trip(), std::move(change));
}

evaluation::RunMetrics run(std::unique_ptr<state::Source> source, const std::string& method,
                           const Settings& settings = Settings::of_paper()) {
  evaluation::RunMetricsCollector collector(source->mounting());
  const std::unique_ptr<state::Estimator> estimator =
      methods::find(method).make(method_options(settings, source->mounting()), collector);
  while (const std::optional<Measurement> measurement = source->next()) {
    estimator->process(*measurement);
  }
  estimator->finish();
  return collector.metrics();
}

std::string text(const evaluation::RunMetrics& m) {
  std::string text = "size " + std::to_string(std::sqrt(m.gnss.mean_nis / 3)) + " of " +
                     std::to_string(m.gnss.used) + ", rejected " + std::to_string(m.gnss.rejected);
  for (const std::string& reason : m.trust.reasons) text += "\n" + reason;
  return text;
}

class Trusted : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, Trusted,
                         ::testing::Values("ekf", "refined", "rough", "full", "rts", "batch"));

TEST_P(Trusted, CleanTrips) {
  for (const int64_t seed : {1, 2, 3}) {
    const evaluation::RunMetrics m = run(trip(seed), GetParam());
    EXPECT_TRUE(m.trust.trustworthy) << text(m);
    // The Earth's rotation neglected shows, with this IMU.
    EXPECT_EQ(m.trust.reasons.empty(), GetParam() != "rough") << text(m);
  }
}

TEST_P(Trusted, TripsWithOutliersOrAHoleInTheImu) {
  const evaluation::RunMetrics outliers =
      run(with_fault({simulation::FaultKind::fix_outliers, 0, kThroughout, 0.1}), GetParam());
  EXPECT_GT(outliers.gnss.rejected, 10);
  EXPECT_TRUE(outliers.trust.trustworthy) << text(outliers);
  const evaluation::RunMetrics hole =
      run(with_fault({simulation::FaultKind::imu_gap, 150, 60}), GetParam());
  EXPECT_TRUE(hole.trust.trustworthy) << text(hole);
}

class Condemned : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, Condemned,
                         ::testing::Values("ekf", "refined", "rough", "full", "rts", "batch"));

/// Or refused before: a recording that is as wrong as that need not be processed.
void expect_condemned(std::unique_ptr<state::Source> source, const std::string& method) {
  try {
    const evaluation::RunMetrics m = run(std::move(source), method);
    ::testing::Test::RecordProperty("size", std::to_string(std::sqrt(m.gnss.mean_nis / 3)));
    EXPECT_FALSE(m.trust.trustworthy) << text(m);
  } catch (const DataError& error) {
    ::testing::Test::RecordProperty("refused", error.what());
  }
}

/// A consumer's IMU with the noise of an industrial one.
TEST_P(Condemned, NoiseOfAnotherClass) {
  imu::ImuNoise vibrating = imu::imu_preset("ADIS16465");
  vibrating.gyro_noise_density *= 20;
  vibrating.accel_noise_density *= 50;
  expect_condemned(trip(1, vibrating), GetParam());
}

TEST_P(Condemned, HalfScale) {
  expect_condemned(with_imu([](ImuIncrement& increment) {
                     increment.dtheta_b *= 0.5;
                     increment.dvel_b *= 0.5;
                   }),
                   GetParam());
}

TEST_P(Condemned, HalfATurnAboutTheVertical) {
  expect_condemned(with_imu([](ImuIncrement& increment) {
                     increment.dtheta_b.head<2>() *= -1;
                     increment.dvel_b.head<2>() *= -1;
                   }),
                   GetParam());
}

TEST_P(Condemned, ClocksThreeTenthsOfASecondApart) {
  expect_condemned(with_fault({simulation::FaultKind::imu_stamps_offset, 0, kThroughout, 0.3}),
                   GetParam());
}

}  // namespace
}  // namespace foucault::app
