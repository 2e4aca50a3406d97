/// What it takes to estimate and to measure something new: a block (one line), an observation (one
/// class), and every method has both.

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "foucault/core/time.h"
#include "foucault/ekf/rts.h"
#include "foucault/evaluation/statistics.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/place.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault {
namespace {

constexpr state::Block kTemperature{"temperature", 1, "K"};
constexpr double kPrior = 5;        // [K]
constexpr double kPerKelvin = 0.1;  // [m/K]
constexpr double kRangeSigma = 0.05;

state::Layout layout() { return state::Layout().add(kTemperature, kPrior); }

/// Range from the IMU to a beacon, too long by kPerKelvin times the temperature.
class BeaconRange final : public measurement::Observation {
 public:
  BeaconRange(const Geodetic& beacon, double range) : beacon_(beacon), range_(range) {}

  std::string_view name() const override { return "beacon_range"; }
  state::Linearized linearize(const state::NavState& x, const measurement::MeanMotion& /*mean*/,
                              const state::Layout& layout) const override {
    const state::SlowBlock& temperature = *layout.find(kTemperature);
    const Eigen::Vector3d way_n =
        geodesy::displacement_n(x.position, beacon_, geodesy::Place(x.position));
    state::Linearized z(1, layout.size());
    z.r[0] = range_ - way_n.norm() - kPerKelvin * x.slow[temperature.index];
    state::columns_of(z.H, state::block::position) = -way_n.normalized().transpose();
    state::columns_of(z.H, temperature).setConstant(kPerKelvin);
    z.R(0, 0) = kRangeSigma * kRangeSigma;
    return z;
  }

 private:
  Geodetic beacon_;
  double range_;
};

/// A trip with fixes and ranges every second but in an outage.
class Trip {
 public:
  explicit Trip(int64_t seed) : rng_(seed) {
    options_.seed = seed;
    options_.duration_s = 60;
    options_.imu_rate_hz = 50;
    options_.reference_rate_hz = 0;
    temperature_ = kPrior * normal_(rng_);
  }

  double temperature() const { return temperature_; }

  void drive(measurement::Navigator& navigator) {
    simulation::SimulatedSource source(options_, noise());
    const Geodetic beacon = geodesy::displaced(options_.start_position(), {200, 150, -30},
                                               geodesy::Place(options_.start_position()));
    navigator.start(initial(source));
    std::optional<GnssFix> fix;
    while (const std::optional<Measurement> m = source.next()) {
      if (const auto* next = std::get_if<GnssFix>(&*m)) fix = *next;
      const auto* increment = std::get_if<ImuIncrement>(&*m);
      if (increment == nullptr) continue;
      navigator.propagate(*increment);
      if (!fix || fix->t_ns != increment->t_end_ns) continue;
      const double t = seconds_between(options_.start_ns(), fix->t_ns);
      if (t > 20 && t < 30) {
        navigator.hold();
        continue;
      }
      navigator.update(measurement::gnss_position(*fix));
      const Geodetic here = source.truth(fix->t_ns).position;
      const double range = geodesy::displacement_n(here, beacon, geodesy::Place(here)).norm();
      navigator.update(std::make_shared<BeaconRange>(
          beacon, range + kPerKelvin * temperature_ + kRangeSigma * normal_(rng_)));
    }
  }

  static imu::ImuNoise noise() { return imu::imu_preset("ADIS16465"); }

 private:
  state::Epoch initial(const simulation::SimulatedSource& source) const {
    state::Epoch epoch = source.truth(options_.start_ns());
    epoch.bias = {};
    auto variance = epoch.covariance.diagonal();
    state::part(variance, state::block::position).setConstant(1e-2);
    state::part(variance, state::block::velocity).setConstant(1e-2);
    state::part(variance, state::block::attitude) << 1e-6, 1e-6, 1e-4;
    state::part(variance, state::block::gyro_bias)
        .setConstant(std::pow(imu::gyro_markov_bias(noise()).sigma, 2));
    state::part(variance, state::block::accel_bias)
        .setConstant(std::pow(imu::accel_markov_bias(noise()).sigma, 2));
    return epoch;
  }

  simulation::ScenarioOptions options_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  double temperature_;
};

using Find = std::function<state::Epoch(Trip&)>;

template <class Recorder>
state::Epoch in_the_outage(Trip& trip, Recorder recorder) {
  trip.drive(recorder);
  return recorder.smoothed()[25].epoch();
}

std::unique_ptr<measurement::Navigator> filter() {
  return std::make_unique<ekf::EkfNavigator>(Trip::noise(), layout(), ekf::EkfOptions{});
}

state::Epoch by_ekf(Trip& trip) {
  const std::unique_ptr<measurement::Navigator> navigator = filter();
  trip.drive(*navigator);
  return navigator->epoch();
}

state::Epoch by_window(Trip& trip) {
  fgo::WindowNavigator window(fgo::FgoOptions{}, preintegration::PreintegrationModel::full,
                              Trip::noise(), layout());
  trip.drive(window);
  return window.epoch();
}

state::Epoch by_rts(Trip& trip) {
  return in_the_outage(trip, ekf::RtsRecorder(Trip::noise(), layout(), ekf::EkfOptions{}));
}

state::Epoch by_batch(Trip& trip) {
  return in_the_outage(
      trip, fgo::BatchRecorder(filter(), fgo::FgoOptions{},
                               preintegration::PreintegrationModel::full, Trip::noise(), layout()));
}

class Extension : public ::testing::TestWithParam<std::pair<const char*, Find>> {};
INSTANTIATE_TEST_SUITE_P(Methods, Extension,
                         ::testing::Values(std::pair("ekf", by_ekf), std::pair("window", by_window),
                                           std::pair("rts", by_rts), std::pair("batch", by_batch)),
                         [](const auto& test) { return std::string(test.param.first); });

TEST_P(Extension, ANewBlockIsFoundByANewMeasurement) {
  constexpr int kRuns = 25;
  double nees = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    Trip trip(seed);
    const state::Epoch epoch = GetParam().second(trip);
    const double error = trip.temperature() - epoch.slow[0];
    const double variance =
        state::part(epoch.covariance.diagonal(), *layout().find(kTemperature))[0];
    EXPECT_LT(std::sqrt(variance), 0.05 * kPrior);
    nees += error * error / variance / kRuns;
  }
  const Band band = evaluation::mean_nees_band(1, kRuns);
  EXPECT_GT(nees, band.low);
  EXPECT_LT(nees, band.high);
}

}  // namespace
}  // namespace foucault
