#include "foucault/calibration/noise_fit.h"

#include <gtest/gtest.h>

#include "foucault/simulation/simulated_source.h"

namespace foucault::calibration {
namespace {

/// A trip whose start is the truth within what an alignment tells.
RecordedWay trip(const imu::ImuNoise& noise, int64_t seed) {
  simulation::ScenarioOptions scenario;
  scenario.duration_s = 400;
  scenario.seed = seed;
  simulation::SimulatedSource source(scenario, noise);
  WayRecorder recorder;
  std::vector<Measurement> all;
  while (std::optional<Measurement> measurement = source.next()) {
    if (const auto* fix = std::get_if<GnssFix>(&*measurement)) recorder.used(fix->t_ns);
    recorder.add(*measurement);
  }
  state::Epoch start = source.truth(scenario.start_ns() + 60'000'000'000);
  start.covariance = state::NodeMatrix::Zero();
  start.covariance.diagonal() << Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(1e-4),
      Eigen::Vector3d::Constant(1e-6),
      Eigen::Vector3d::Constant(std::pow(noise.gyro_turn_on_sigma, 2)),
      Eigen::Vector3d::Constant(std::pow(noise.accel_turn_on_sigma, 2));
  recorder.epoch(start);
  return *recorder.way();
}

imu::ImuNoise told() { return imu::imu_preset("ADIS16465"); }

TEST(NoiseFit, WhatIsRightIsKept) {
  for (const int64_t seed : {1, 2, 3}) {
    const NoiseFit fit = raised_noise(trip(told(), seed), told(), {});
    EXPECT_EQ(fit.gain, 0) << seed;
    EXPECT_EQ(fit.noise.accel_noise_density, told().accel_noise_density) << seed;
    EXPECT_EQ(fit.noise.gyro_noise_density, told().gyro_noise_density) << seed;
  }
}

/// By powers of two, to which six minutes of fixes know it.
TEST(NoiseFit, WhiteNoiseThatIsEightTimesAsLargeIsFound) {
  imu::ImuNoise loud = told();
  loud.accel_noise_density *= 8;
  const NoiseFit fit = raised_noise(trip(loud, 4), told(), {});
  EXPECT_GT(fit.gain, 20);
  EXPECT_GT(fit.noise.accel_noise_density, 3.9 * told().accel_noise_density);
  EXPECT_LT(fit.noise.accel_noise_density, 16.1 * told().accel_noise_density);
}

/// From fix to fix it looks like white noise, in part; what was found explains as much.
TEST(NoiseFit, BiasesThatWanderFortyTimesAsFarAreExplained) {
  imu::ImuNoise wandering = told();
  wandering.accel_bias_sigma *= 40;
  wandering.bias_tau = 300;
  imu::ImuNoise of_told = told();
  of_told.bias_tau = 300;
  const RecordedWay way = trip(wandering, 5);
  const NoiseFit fit = raised_noise(way, of_told, {});
  EXPECT_GT(fit.gain, 20);
  const double before = log_likelihood(way, of_told, {});
  const double truth = log_likelihood(way, wandering, {});
  EXPECT_GT(log_likelihood(way, fit.noise, {}) - before, 0.9 * (truth - before));
}

/// What is too large is left: innovations of a minute cannot say what an outage will be like.
TEST(NoiseFit, NothingIsLowered) {
  imu::ImuNoise quiet = told();
  quiet.accel_noise_density /= 8;
  const NoiseFit fit = raised_noise(trip(quiet, 6), told(), {});
  EXPECT_EQ(fit.noise.accel_noise_density, told().accel_noise_density);
}

TEST(NoiseFit, ThoseOfTheRecordingAreTheMostLikely) {
  const RecordedWay way = trip(told(), 7);
  const double right = log_likelihood(way, told(), {});
  for (const double factor : {0.2, 5.0}) {
    imu::ImuNoise wrong = told();
    wrong.accel_noise_density *= factor;
    wrong.gyro_noise_density *= factor;
    EXPECT_LT(log_likelihood(way, wrong, {}), right) << factor;
  }
}

}  // namespace
}  // namespace foucault::calibration
