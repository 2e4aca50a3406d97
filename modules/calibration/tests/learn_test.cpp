#include "foucault/calibration/learn.h"

#include <gtest/gtest.h>

#include <map>

#include "trip.h"

namespace foucault::calibration {
namespace {

Learned learned(const Trip& trip, const imu::ImuNoise& told, LearnOptions options = {}) {
  NoiseModel model;
  model.imu = told;
  const std::vector<RecordedWay> ways{trip.way()};
  options.axes = axes_of(ways).all();
  return learn(ways, model, options);
}

double by_truth(const Learned& learned, const imu::ImuNoise& truth, const NoiseAxis& axis) {
  NoiseModel model;
  model.imu = truth;
  return axis.value(learned.noise) / axis.value(model);
}

const LearnedAxis& axis_of(const Learned& learned, const NoiseAxis& axis) {
  for (const LearnedAxis& one : learned.axes)
    if (one.axis.name == axis.name) return one;
  throw std::logic_error("not learned");
}

imu::ImuNoise times(imu::ImuNoise noise, double white, double variation) {
  noise.gyro_noise_density *= white;
  noise.accel_noise_density *= white;
  noise.gyro_bias_sigma *= variation;
  noise.accel_bias_sigma *= variation;
  return noise;
}

/// Told wrongly by five either way, with and against each other. White noise is known to a tenth
/// by a quarter of an hour.
TEST(Learn, FindsTheNoiseFromWrongDataSheets) {
  for (const auto& [white, variation] : {std::pair{5.0, 5.0}, {0.2, 0.2}, {5.0, 0.2}, {0.2, 5.0}}) {
    Trip trip;
    trip.scenario.seed = 11;
    trip.told = times(trip.noise, white, variation);
    const Learned found = learned(trip, trip.told);
    EXPECT_GT(found.gain, 30);
    for (const NoiseAxis* axis : {&noise_axis::accel_white, &noise_axis::gyro_white}) {
      const double sigma = axis_of(found, *axis).log_sigma;
      EXPECT_LT(std::abs(std::log(by_truth(found, trip.noise, *axis))), 4 * sigma)
          << axis->name << ' ' << white << ' ' << variation;
      EXPECT_LT(sigma, 0.4);
      EXPECT_TRUE(axis_of(found, *axis).observable);
    }
    EXPECT_NEAR(found.noise.fix_white, 1, 0.15);
    for (const NormalizedError& size : found.after)
      EXPECT_NEAR(size.mean, 1, 0.5) << size.horizon_s;
  }
}

/// What differs is within its sigmas: over ten trips the mean square of errors in sigmas is one,
/// within a factor of three.
TEST(Learn, SaysHowSureItIs) {
  double square = 0, bias = 0;
  int count = 0;
  for (const int64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
    Trip trip;
    trip.scenario.seed = seed;
    const Learned found = learned(trip, trip.told);
    for (const NoiseAxis* axis : {&noise_axis::accel_white, &noise_axis::gyro_white}) {
      const double error = std::log(by_truth(found, trip.noise, *axis));
      square += std::pow(error / axis_of(found, *axis).log_sigma, 2);
      bias += error;
      ++count;
    }
  }
  EXPECT_LT(square / count, 3);
  EXPECT_GT(square / count, 1.0 / 3);
  EXPECT_NEAR(bias / count, 0, 0.15);
}

/// Fixes that are better than they say are no quieter IMU, and those that are worse no louder one.
TEST(Learn, TellsFixesFromTheImu) {
  for (const double factor : {0.5, 2.0}) {
    Trip trip;
    trip.scenario.seed = 3;
    trip.told_sigma_factor = factor;
    const Learned found = learned(trip, trip.told);
    EXPECT_NEAR(found.noise.fix_white, 1 / factor, 0.15 / factor);
    EXPECT_NEAR(std::log(by_truth(found, trip.noise, noise_axis::gyro_white)), 0, 0.3);
  }
}

/// Fixes whose errors hardly differ from one to the next: taken for white, they are better than
/// their sigmas, and the accelerometers far noisier than they are. Beside a part that lasts, all
/// are found; and the sigma for those who know no such part is larger.
TEST(Learn, ErrorsOfFixesThatLastAreNoNoiseOfTheImu) {
  Trip trip;
  trip.scenario.duration_s = 450;
  trip.scenario.gnss_rate_hz = 4;
  trip.scenario.gnss_sigma_m = {0.05, 0.05, 0.1};
  trip.scenario.gnss_white_sigma = 0.05;
  trip.scenario.gnss_coloured_sigma = 1;
  trip.scenario.gnss_coloured_tau_s = 12;
  LearnOptions options;
  options.starts = 20;
  const Learned white = learned(trip, trip.told, options);
  EXPECT_LT(white.noise.fix_white, 0.8);
  EXPECT_GT(by_truth(white, trip.noise, noise_axis::accel_white), 10);

  options.lasting = true;
  const Learned found = learned(trip, trip.told, options);
  ASSERT_TRUE(found.lasting);
  EXPECT_NEAR(found.lasting->sigmas, 1, 0.3);
  EXPECT_GT(found.lasting->tau_s, 6);
  EXPECT_LT(found.lasting->tau_s, 24);
  EXPECT_LT(by_truth(found, trip.noise, noise_axis::accel_white), 3);
  EXPECT_GT(found.noise.fix_white, 1.5 * white.noise.fix_white);
  EXPECT_EQ(found.axes.size(), white.axes.size());
}

TEST(Learn, WhiteErrorsDoNotLast) {
  Trip trip;
  trip.scenario.seed = 4;
  LearnOptions options;
  options.lasting = true;
  EXPECT_FALSE(learned(trip, trip.told, options).lasting);
}

/// Two minutes do not show how far a bias wanders in an hour.
TEST(Learn, SaysWhatTheRecordingCannotTell) {
  Trip trip;
  trip.scenario.duration_s = 180;
  const Learned found = learned(trip, trip.told);
  EXPECT_FALSE(axis_of(found, noise_axis::accel_bias).observable);
  EXPECT_TRUE(axis_of(found, noise_axis::fix_white).observable);
}

TEST(Learn, GivesTheSameTwice) {
  Trip trip;
  trip.scenario.duration_s = 300;
  const Learned once = learned(trip, trip.told), again = learned(trip, trip.told);
  EXPECT_EQ(once.noise.imu.gyro_noise_density, again.noise.imu.gyro_noise_density);
  EXPECT_EQ(once.gain, again.gain);
}

}  // namespace
}  // namespace foucault::calibration
