#include "foucault/imu/imu_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"

namespace foucault::imu {
namespace {

constexpr double kRounding = 1e-12;  // relative; the values are a few products of constants

void expect_near_relative(double value, double expected) {
  EXPECT_NEAR(value, expected, kRounding * std::abs(expected));
}

TEST(ImuNoise, PresetInSiUnits) {
  const ImuNoise noise = imu_preset("ADIS16465");
  expect_near_relative(noise.gyro_noise_density, 0.15 * kDegree / 60);
  expect_near_relative(noise.accel_noise_density, 0.012 / 60);
  expect_near_relative(noise.gyro_bias_sigma, 2 * kDegree / 3600);
  expect_near_relative(noise.accel_bias_sigma, 3.6e-6 * kStandardGravity);
  expect_near_relative(noise.bias_tau, 3600);
  expect_near_relative(noise.gyro_turn_on_sigma, 100 * kDegree / 3600);
  expect_near_relative(noise.accel_turn_on_sigma, 1.4e-3 * kStandardGravity);
}

TEST(ImuNoise, WhiteNoiseGivenInMicroG) {
  expect_near_relative(imu_preset("ICM20602").accel_noise_density, 100e-6 * kStandardGravity);
}

TEST(ImuNoise, BetterGradesAreBetterInEveryNumber) {
  const ImuNoise worse = imu_preset("tactical");
  const ImuNoise better = imu_preset("navigation");
  const ImuNoise worst = imu_preset("HGuide-i300");
  EXPECT_LT(worse.gyro_noise_density, worst.gyro_noise_density);
  EXPECT_LT(worse.gyro_bias_sigma, worst.gyro_bias_sigma);
  EXPECT_LT(better.gyro_noise_density, worse.gyro_noise_density);
  EXPECT_LT(better.accel_noise_density, worse.accel_noise_density);
  EXPECT_LT(better.gyro_bias_sigma, worse.gyro_bias_sigma);
  EXPECT_LT(better.accel_bias_sigma, worse.accel_bias_sigma);
  EXPECT_LT(better.gyro_turn_on_sigma, worse.gyro_turn_on_sigma);
  EXPECT_LT(better.accel_turn_on_sigma, worse.accel_turn_on_sigma);
}

TEST(ImuNoise, DataSheetsOfConsumerAndPhone) {
  const ImuNoise consumer = imu_preset("consumer"), phone = imu_preset("phone");
  expect_near_relative(consumer.gyro_noise_density, 0.01 * kDegree);  // MPU-9250
  expect_near_relative(consumer.accel_noise_density, 300e-6 * kStandardGravity);
  expect_near_relative(phone.gyro_noise_density, 0.007 * kDegree);  // BMI160
  expect_near_relative(phone.accel_noise_density, 180e-6 * kStandardGravity);
}

/// Variance and driving noise q = 2 sigma^2 / tau are those of turn-on value plus variation.
TEST(ImuNoise, BiasAsOneMarkovProcess) {
  const ImuNoise noise = imu_preset("navigation");
  const MarkovBias gyro = gyro_markov_bias(noise);
  expect_near_relative(gyro.sigma, std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma));
  expect_near_relative(2 * gyro.sigma * gyro.sigma / gyro.tau, noise.gyro_bias_power());
  const MarkovBias accel = accel_markov_bias(noise);
  expect_near_relative(2 * accel.sigma * accel.sigma / accel.tau, noise.accel_bias_power());
  ImuNoise plain = noise;
  plain.gyro_turn_on_sigma = 0;
  expect_near_relative(gyro_markov_bias(plain).tau, plain.bias_tau);
  plain.accel_bias_sigma = 0;
  EXPECT_TRUE(std::isinf(accel_markov_bias(plain).tau));
}

TEST(ImuNoise, EveryNamedPresetIsComplete) {
  for (const std::string& name : imu_preset_names()) {
    const ImuNoise n = imu_preset(name);
    for (const double value :
         {n.gyro_noise_density, n.accel_noise_density, n.gyro_bias_sigma, n.accel_bias_sigma,
          n.bias_tau, n.gyro_turn_on_sigma, n.accel_turn_on_sigma}) {
      EXPECT_GT(value, 0) << name;
    }
  }
}

TEST(ImuNoise, DrivingNoiseKeepsTheSteadyStateSigma) {
  // A first-order Gauss-Markov process has the steady-state variance q tau / 2.
  const ImuNoise noise = imu_preset("ADIS16460");
  expect_near_relative(noise.gyro_bias_power() * noise.bias_tau / 2,
                       noise.gyro_bias_sigma * noise.gyro_bias_sigma);
  expect_near_relative(noise.accel_bias_power() * noise.bias_tau / 2,
                       noise.accel_bias_sigma * noise.accel_bias_sigma);
}

TEST(ImuNoise, UnknownPresetNamesTheKnown) {
  try {
    imu_preset("ADIS16466");
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("ADIS16465"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("ADIS16466"), std::string::npos) << error.what();
  }
}

/// It is a choice of the configuration, and no IMU: nobody can ask for its noise by name.
TEST(ImuOptions, AutoIsAChoiceAndNoPreset) {
  ImuOptions options;
  load_config_text("{preset: auto}", "test", options);
  EXPECT_EQ(options.preset, "auto");
  EXPECT_EQ(options.completed_by(ImuOptions()).preset, "auto");
  EXPECT_THROW(imu_preset("auto"), UsageError);
}

TEST(ImuOptions, OverridesReplaceSingleValuesInTheirUnits) {
  ImuOptions options;
  load_config_text(
      "{preset: HGuide-i300, samples: instantaneous, arw_deg_sqrt_h: 6, vrw_m_s_sqrt_h: 0.6,"
      " gyro_bias_deg_h: 3600, accel_bias_mgal: 1000, bias_tau_s: 100, gyro_turn_on_deg_h: 7200,"
      " accel_turn_on_mgal: 2000}",
      "test", options);
  const ImuNoise noise = options.noise();
  expect_near_relative(noise.gyro_noise_density, 0.1 * kDegree);
  expect_near_relative(noise.accel_noise_density, 0.01);
  expect_near_relative(noise.gyro_bias_sigma, kDegree);
  expect_near_relative(noise.accel_bias_sigma, 0.01);
  expect_near_relative(noise.bias_tau, 100);
  expect_near_relative(noise.gyro_turn_on_sigma, 2 * kDegree);
  expect_near_relative(noise.accel_turn_on_sigma, 0.02);
  EXPECT_EQ(options.sample_kind(), SampleKind::instantaneous);
}

TEST(ImuOptions, DefaultIsThePreset) {
  EXPECT_EQ(ImuOptions().noise().gyro_bias_sigma, imu_preset("ADIS16465").gyro_bias_sigma);
  EXPECT_EQ(ImuOptions().sample_kind(), SampleKind::interval_mean);
}

TEST(ImuOptions, CompletedByWhatTheLogSays) {
  ImuOptions recorded;
  recorded.samples = "instantaneous";
  recorded.arw_deg_sqrt_h = 3.5;
  ImuOptions open;
  open.vrw_m_s_sqrt_h = 0.5;
  const ImuOptions both = open.completed_by(recorded);
  EXPECT_EQ(both.sample_kind(), SampleKind::instantaneous);
  EXPECT_EQ(both.preset, "ADIS16465");
  EXPECT_EQ(both.arw_deg_sqrt_h, 3.5);
  EXPECT_EQ(both.vrw_m_s_sqrt_h, 0.5);

  recorded.preset = "ICM20602";
  EXPECT_EQ(open.completed_by(recorded).preset, "ICM20602");
  ImuOptions chosen;  // a preset is another sensor: none of the log's noise is mixed in
  chosen.preset = "navigation";
  chosen.samples = "interval_mean";
  const ImuOptions of_chosen = chosen.completed_by(recorded);
  EXPECT_EQ(of_chosen.preset, "navigation");
  EXPECT_FALSE(of_chosen.arw_deg_sqrt_h);
  EXPECT_EQ(of_chosen.sample_kind(), SampleKind::interval_mean);

  const ImuOptions by_nothing = ImuOptions().completed_by(ImuOptions());
  EXPECT_EQ(by_nothing.preset, "ADIS16465");
  EXPECT_EQ(by_nothing.samples, "interval_mean");
}

TEST(ImuOptions, WrongValuesAreUsageErrors) {
  ImuOptions options;
  EXPECT_THROW(set_config("preset=Wii", options), UsageError);
  EXPECT_THROW(set_config("samples=mean", options), UsageError);
  EXPECT_THROW(set_config("bias_tau_s=0", options), UsageError);
  EXPECT_THROW(set_config("arw_deg_sqrt_h=-1", options), UsageError);
}

}  // namespace
}  // namespace foucault::imu
