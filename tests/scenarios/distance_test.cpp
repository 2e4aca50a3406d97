/// Trips far from their start, over 180 deg of longitude and near the poles: exact physics drifts
/// alike everywhere, and what comes out is resolved where the vehicle is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/ekf/ekf.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr double kDeg = 3.14159265358979323846 / 180;

std::unique_ptr<measurement::Navigator> make_navigator(const std::string& method,
                                                       const imu::ImuNoise& noise) {
  if (method == "ekf")
    return std::make_unique<ekf::EkfNavigator>(noise, state::Layout{}, ekf::EkfOptions{});
  const preintegration::PreintegrationModel model =
      method == "full" ? preintegration::PreintegrationModel::full
                       : preintegration::PreintegrationModel::refined;
  return std::make_unique<fgo::WindowNavigator>(fgo::FgoOptions{}, model, noise);
}

evaluation::EstimatorFactory factory(const std::string& method, const imu::ImuNoise& noise) {
  return [method, noise](const state::Mounting& mounting, state::Sink& sink) {
    return std::make_unique<navigation::NavigationRun>(
        make_navigator(method, noise),
        alignment::Aligner(alignment::AlignmentOptions{}, noise, mounting),
        navigation::NavigationRunOptions{}, sink);
  };
}

/// Errors against the truth, and the longitudes passed.
class Observer : public evaluation::OutageRunObserver {
 public:
  explicit Observer(const state::Mounting& mounting, int64_t from_ns)
      : metrics_(mounting, from_ns) {}
  void epoch(const state::Epoch& epoch) override {
    metrics_.epoch(epoch);
    longitudes.push_back(epoch.position.longitude);
  }
  void fix(const state::FixResult& fix) override { metrics_.fix(fix); }
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error) override {
    metrics_.reference_error(epoch, error);
  }
  evaluation::RunMetrics metrics() const { return metrics_.metrics(); }

  std::vector<double> longitudes;

 private:
  evaluation::RunMetricsCollector metrics_;
};

struct Outcome {
  evaluation::OutageRunResult run;
  evaluation::RunMetrics metrics;
  std::vector<double> longitudes;
};

Outcome run(const std::string& method, const simulation::ScenarioOptions& scenario,
            const imu::ImuNoise& noise, const evaluation::OutageSchedule& schedule,
            double settle_s = 150) {
  auto source = std::make_unique<simulation::SimulatedSource>(scenario, noise);
  Observer observer(source->mounting(), scenario.start_ns() + nanoseconds(settle_s));
  Outcome outcome;
  outcome.run = evaluation::run_with_outages(std::move(source), schedule, factory(method, noise),
                                             {}, &observer);
  outcome.metrics = observer.metrics();
  outcome.longitudes = observer.longitudes;
  return outcome;
}

struct Rms {
  double horizontal = 0, vertical = 0;
  std::size_t outages = 0;
};

/// RMS of the largest drift over the outages that begin at [from, to) km.
Rms drift_rms(const Outcome& outcome, double from_km, double to_km) {
  std::vector<double> horizontal, vertical;
  for (const evaluation::OutageDrift& drift : outcome.run.drifts) {
    const double km = drift.distance_m * 1e-3;
    if (km < from_km || km >= to_km) continue;
    horizontal.push_back(drift.maximum.horizontal);
    vertical.push_back(drift.maximum.vertical);
  }
  if (horizontal.empty()) return {};
  return {evaluation::root_mean_square(horizontal), evaluation::root_mean_square(vertical),
          horizontal.size()};
}

evaluation::OutageSchedule outages(double first_s, double length_s, double period_s) {
  evaluation::OutageOptions options;
  options.first_s = first_s;
  options.length_s = length_s;
  options.period_s = period_s;
  return evaluation::OutageSchedule(options, 0);
}

void expect_alike(const Rms& full, const Rms& ekf, double share) {
  EXPECT_EQ(full.outages, ekf.outages);
  EXPECT_NEAR(full.horizontal, ekf.horizontal, share * ekf.horizontal);
  EXPECT_NEAR(full.vertical, ekf.vertical, share * ekf.vertical);
}

/// From 78 deg north over the 180 deg meridian, 200 km along a latitude circle whose north turns
/// by 17 deg on the way: what is left is the filter's own accuracy.
TEST(Airliner, FullIsTheEkfHundredsOfKilometresAwayAndRefinedIsNot) {
  simulation::ScenarioOptions scenario;
  scenario.name = "airliner";
  scenario.seed = 4;
  scenario.duration_s = 1500;
  scenario.imu_rate_hz = 50;
  scenario.latitude_deg = 78;
  scenario.longitude_deg = 176;
  scenario.heading_deg = 80;
  scenario.rest_s = 60;
  const imu::ImuNoise noise = imu::imu_preset("navigation");
  const evaluation::OutageSchedule schedule = outages(500, 60, 90);
  const Outcome ekf = run("ekf", scenario, noise, schedule);
  const Outcome full = run("full", scenario, noise, schedule);
  const Outcome refined = run("refined", scenario, noise, schedule);

  EXPECT_GT(ekf.run.drifts.back().distance_m, 200e3);
  EXPECT_LT(full.longitudes.back(), 0);  // on the other side of the meridian
  const Rms of_ekf = drift_rms(ekf, 0, 1000);
  EXPECT_EQ(of_ekf.outages, 11u);
  // Decimetres, of the sensor's own noise; a gyroscope of 0.002 deg/sqrt(h) allows no more.
  EXPECT_LT(of_ekf.horizontal, 0.3);
  expect_alike(drift_rms(full, 0, 1000), of_ekf, 0.02);
  const Rms of_refined = drift_rms(refined, 0, 1000);
  EXPECT_GT(of_refined.horizontal, 50 * of_ekf.horizontal);
  EXPECT_GT(of_refined.vertical, 50 * of_ekf.vertical);
  for (const Outcome* outcome : {&ekf, &full}) {
    const evaluation::ReferenceMetrics& errors = *outcome->metrics.reference;
    EXPECT_LT(errors.heading_rmse, 0.02 * kDeg);
    EXPECT_LT(std::max(errors.roll_rmse, errors.pitch_rmse), 0.005 * kDeg);
    EXPECT_NEAR(errors.attitude_inside.fraction.col(2).minCoeff(), 1, 0.1);
  }
}

/// The same at 60 km as at the start, with a gyroscope that sees 1 deg/h.
TEST(Motorway, FullIsTheEkfNearAndFar) {
  simulation::ScenarioOptions scenario;
  scenario.name = "motorway";
  scenario.seed = 2;
  scenario.duration_s = 2200;
  scenario.imu_rate_hz = 50;
  const imu::ImuNoise noise = imu::imu_preset("tactical");
  const evaluation::OutageSchedule schedule = outages(200, 60, 90);
  const Outcome ekf = run("ekf", scenario, noise, schedule);
  const Outcome full = run("full", scenario, noise, schedule);
  EXPECT_GT(ekf.run.drifts.back().distance_m, 55e3);
  for (const auto& [from_km, to_km] : {std::pair{0.0, 30.0}, std::pair{30.0, 100.0}}) {
    const Rms of_ekf = drift_rms(ekf, from_km, to_km);
    EXPECT_GE(of_ekf.outages, 9u);
    EXPECT_LT(of_ekf.horizontal, 5);
    expect_alike(drift_rms(full, from_km, to_km), of_ekf, 0.01);
  }
}

/// latitude and longitude of the start, heading [deg].
struct Place {
  const char* name;
  double latitude, longitude, heading;
};

class Antimeridian : public testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(All, Antimeridian,
                         testing::Values(Place{"north_eastward", 80, 179.9, 90},
                                         Place{"north_westward", 80, -179.9, -90},
                                         Place{"south_eastward", -80, 179.9, 90},
                                         Place{"equator_westward", 0, -179.98, -90}),
                         [](const auto& place) { return place.param.name; });

TEST_P(Antimeridian, NothingJumps) {
  simulation::ScenarioOptions scenario;
  scenario.name = "motorway";
  scenario.seed = 6;
  scenario.duration_s = 260;
  scenario.imu_rate_hz = 50;
  scenario.latitude_deg = GetParam().latitude;
  scenario.longitude_deg = GetParam().longitude;
  scenario.heading_deg = GetParam().heading;
  for (const char* method : {"ekf", "refined", "full"}) {
    const Outcome outcome =
        run(method, scenario, imu::imu_preset("tactical"), outages(200, 30, 60));
    EXPECT_LT(outcome.longitudes.front() * outcome.longitudes.back(), 0) << method;
    for (std::size_t i = 1; i < outcome.longitudes.size(); ++i) {
      const double step = so3::wrap(outcome.longitudes[i] - outcome.longitudes[i - 1]);
      ASSERT_LT(std::abs(step), 1e-4) << method;  // 32 m at 80 deg: 3e-5
    }
    EXPECT_EQ(outcome.metrics.gnss.rejected, 0) << method;
    ASSERT_EQ(outcome.run.drifts.size(), 1u);
    EXPECT_LT(outcome.run.drifts[0].maximum.horizontal, 2) << method;
    const evaluation::ReferenceMetrics& errors = *outcome.metrics.reference;
    EXPECT_LT(errors.heading_rmse, 0.3 * kDeg) << method;
    EXPECT_LT(std::max(errors.roll_rmse, errors.pitch_rmse), 0.05 * kDeg) << method;
  }
}

/// Keeps the last epoch.
class LastEpoch : public state::Sink {
 public:
  void epoch(const state::Epoch& epoch) override { last = epoch; }
  state::Epoch last;
};

struct MeanNees {
  double position = 0, velocity = 0, attitude = 0;
};

constexpr int kRuns = 12;

/// Errors at the end of the trip by their covariance, trip and sensor errors drawn anew each time.
MeanNees mean_nees(const std::string& method, simulation::ScenarioOptions scenario,
                   const imu::ImuNoise& noise) {
  MeanNees mean;
  for (scenario.seed = 1; scenario.seed <= kRuns; ++scenario.seed) {
    simulation::SimulatedSource source(scenario, noise);
    LastEpoch sink;
    const std::unique_ptr<state::Estimator> estimator =
        factory(method, noise)(source.mounting(), sink);
    while (const std::optional<Measurement> measurement = source.next()) {
      estimator->process(*measurement);
    }
    estimator->finish();
    const state::Epoch& estimate = sink.last;
    const state::Epoch truth = source.truth(estimate.t_ns);
    const auto normalized = [&](const Eigen::Vector3d& error, const state::NodeBlock& of) {
      return evaluation::normalized_square(error, estimate.covariance_of(of)).value() / kRuns;
    };
    mean.position +=
        normalized(geodesy::ned_offset(estimate.position, truth.position), state::block::position);
    mean.velocity += normalized(truth.velocity_n - estimate.velocity_n, state::block::velocity);
    mean.attitude +=
        normalized(so3::log(estimate.q_n_b.conjugate() * truth.q_n_b), state::block::attitude);
  }
  return mean;
}

struct Far {
  const char* scenario;
  const char* imu;
};

class FarConsistency : public testing::TestWithParam<Far> {};
INSTANTIATE_TEST_SUITE_P(Trips, FarConsistency,
                         testing::Values(Far{"airliner", "navigation"},
                                         Far{"motorway", "tactical"}),
                         [](const auto& far) { return far.param.scenario; });

TEST_P(FarConsistency, MeanNeesLiesInItsBand) {
  simulation::ScenarioOptions scenario;
  scenario.name = GetParam().scenario;
  scenario.duration_s = 300;
  scenario.imu_rate_hz = 50;
  scenario.reference_rate_hz = 0;
  const imu::ImuNoise noise = imu::imu_preset(GetParam().imu);
  const Band band = evaluation::mean_nees_band(3, kRuns);
  for (const char* method : {"ekf", "full"}) {
    const MeanNees nees = mean_nees(method, scenario, noise);
    for (const double value : {nees.position, nees.velocity, nees.attitude}) {
      EXPECT_GT(value, band.low) << method;
      EXPECT_LT(value, band.high) << method;
    }
  }
}

/// What the band is to see: gravity of the runway, felt tens of kilometres away at 250 m/s.
TEST(FarConsistencyControl, RefinedIsFarOutsideOnAFlight) {
  simulation::ScenarioOptions scenario;
  scenario.name = "airliner";
  scenario.duration_s = 300;
  scenario.imu_rate_hz = 50;
  scenario.reference_rate_hz = 0;
  const MeanNees nees = mean_nees("refined", scenario, imu::imu_preset("navigation"));
  EXPECT_GT(nees.attitude, 100 * evaluation::mean_nees_band(3, kRuns).high);
}

}  // namespace
}  // namespace foucault
