#include "foucault/imu/imu_noise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <limits>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"

namespace foucault::imu {

namespace {

constexpr double kSqrtHour = 60;  // [sqrt(s)]

constexpr double kDegPerSqrtHour = kDegree / kSqrtHour;    // to rad/s/sqrt(Hz)
constexpr double kMPerSPerSqrtHour = 1 / kSqrtHour;        // to m/s^2/sqrt(Hz)
constexpr double kDegPerHour = kDegree / kSecondsPerHour;  // to rad/s
constexpr double kMilliGal = 1e-5;                         // to m/s^2
constexpr double kMilliG = 1e-3 * kStandardGravity;        // to m/s^2
constexpr double kMicroG = 1e-6 * kStandardGravity;        // to m/s^2, or per sqrt(Hz) alike

struct Preset {
  const char* name;
  ImuNoise noise;
};

// Order of the values: that of ImuNoise.
//
// The four IMUs of the paper. Gyroscope bias instability: Table I. White noise and accelerometer
// bias instability: the makers' data sheets (InvenSense ICM-20602, Analog Devices ADIS16460 and
// ADIS16465, Honeywell HGuide i300). The ICM-20602's sheet gives no accelerometer bias instability:
// 0.5 mg is an assumption, half of what the authors found by tuning (1000 mGal). Turn-on sigmas are
// what we assume is left after factory calibration; data sheets do not give them.
//
// consumer: InvenSense MPU-9250 data sheet (PS-MPU-9250A-01, 1.1): 0.01 deg/s/sqrt(Hz), 300
// ug/sqrt(Hz), 5 deg/s and 60 mg at turn-on at most. phone: Bosch BMI160 data sheet
// (BST-BMI160-DS000): 0.007 deg/s/sqrt(Hz), 180 ug/sqrt(Hz), 3 deg/s and 40 mg, less what phones
// calibrate themselves. Bias variations are in neither sheet, assumed: twice those of the
// ICM-20602, and five and four times for what warms and cools in a hand. Of turn-on values a tenth
// and a half of the sheet's limit, of a phone's a thirtieth and a half.
//
// tactical: Northrop Grumman LN-200 (fibre-optic gyros) data sheet: 0.07 deg/sqrt(h), 1 deg/h bias
// repeatability, 0.35 deg/h bias variation; accelerometers 35 ug/sqrt(Hz), 300 ug, 50 ug.
// navigation: Honeywell HG9900 (ring laser gyros) data sheet: 0.002 deg/sqrt(h), 0.0035 deg/h bias;
// accelerometers 25 ug bias. Not in the sheet, assumed as usual for the class: bias variation of a
// third of the bias, 5 ug/sqrt(Hz).
constexpr std::array<Preset, 8> kPresets{{
    {"ICM20602",
     {0.24 * kDegPerSqrtHour, 100 * kMicroG, 10 * kDegPerHour, 0.5 * kMilliG, 3600,
      360 * kDegPerHour, 5 * kMilliG}},
    {"ADIS16460",
     {0.12 * kDegPerSqrtHour, 0.09 * kMPerSPerSqrtHour, 8 * kDegPerHour, 0.2 * kMilliG, 3600,
      180 * kDegPerHour, 1.5 * kMilliG}},
    {"ADIS16465",
     {0.15 * kDegPerSqrtHour, 0.012 * kMPerSPerSqrtHour, 2 * kDegPerHour, 3.6 * kMicroG, 3600,
      100 * kDegPerHour, 1.4 * kMilliG}},
    {"HGuide-i300",
     {0.15 * kDegPerSqrtHour, 0.033 * kMPerSPerSqrtHour, 3 * kDegPerHour, 0.02 * kMilliG, 3600,
      60 * kDegPerHour, 0.5 * kMilliG}},
    {"consumer",
     {0.6 * kDegPerSqrtHour, 300 * kMicroG, 20 * kDegPerHour, 1 * kMilliG, 3600, 1800 * kDegPerHour,
      30 * kMilliG}},
    {"phone",
     {0.42 * kDegPerSqrtHour, 180 * kMicroG, 50 * kDegPerHour, 2 * kMilliG, 3600, 360 * kDegPerHour,
      20 * kMilliG}},
    {"tactical",
     {0.07 * kDegPerSqrtHour, 35 * kMicroG, 0.35 * kDegPerHour, 50 * kMicroG, 3600, 1 * kDegPerHour,
      300 * kMicroG}},
    {"navigation",
     {0.002 * kDegPerSqrtHour, 5 * kMicroG, 0.001 * kDegPerHour, 8 * kMicroG, 3600,
      0.0035 * kDegPerHour, 25 * kMicroG}},
}};

MarkovBias markov_bias(double turn_on_sigma, double sigma, double tau) {
  const double variance = turn_on_sigma * turn_on_sigma + sigma * sigma;
  if (sigma == 0) return {turn_on_sigma, std::numeric_limits<double>::infinity()};
  return {std::sqrt(variance), tau * variance / (sigma * sigma)};
}

constexpr const char* kDefaultPreset = "ADIS16465";

std::vector<std::string> choices_and(std::vector<std::string> names) {
  names.insert(names.begin(), {ImuOptions::kAsRecorded, "auto"});
  return names;
}

void override_with(const std::optional<double>& value, double unit, double& target) {
  if (value) target = *value * unit;
}

}  // namespace

MarkovBias gyro_markov_bias(const ImuNoise& noise) {
  return markov_bias(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma, noise.bias_tau);
}

MarkovBias accel_markov_bias(const ImuNoise& noise) {
  return markov_bias(noise.accel_turn_on_sigma, noise.accel_bias_sigma, noise.bias_tau);
}

std::vector<std::string> imu_preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

ImuNoise imu_preset(const std::string& name) {
  for (const Preset& preset : kPresets) {
    if (name == preset.name) return preset.noise;
  }
  throw UsageError(fmt::format("imu.preset: unknown IMU '{}'; use one of {}", name,
                               fmt::join(imu_preset_names(), ", ")));
}

void ImuOptions::fields(ConfigFields& f) {
  f.text("preset", preset, choices_and(imu_preset_names()),
         "IMU whose noise is taken, keys below override it; as_recorded: what the log says, else "
         "ADIS16465; auto: learned from the recording, from the preset that is nearest");
  f.text("samples", samples, {kAsRecorded, "interval_mean", "instantaneous"},
         "interval_mean: mean over the interval that ends at the stamp; instantaneous: at the "
         "stamp; as_recorded: what the log says, else interval_mean");
  f.optional_number("arw_deg_sqrt_h", arw_deg_sqrt_h, kNotNegative,
                    "gyroscope white noise (angle random walk)");
  f.optional_number("vrw_m_s_sqrt_h", vrw_m_s_sqrt_h, kNotNegative,
                    "accelerometer white noise (velocity random walk)");
  f.optional_number("gyro_bias_deg_h", gyro_bias_deg_h, kNotNegative,
                    "gyroscope bias variation, 1 sigma");
  f.optional_number("accel_bias_mgal", accel_bias_mgal, kNotNegative,
                    "accelerometer bias variation, 1 sigma");
  f.optional_number("bias_tau_s", bias_tau_s, kPositive, "correlation time of the biases");
  f.optional_number("gyro_turn_on_deg_h", gyro_turn_on_deg_h, kNotNegative,
                    "gyroscope turn-on bias, 1 sigma");
  f.optional_number("accel_turn_on_mgal", accel_turn_on_mgal, kNotNegative,
                    "accelerometer turn-on bias, 1 sigma");
}

ImuNoise ImuOptions::noise() const {
  const bool named = preset != kAsRecorded && preset != "auto";
  ImuNoise noise = imu_preset(named ? preset : kDefaultPreset);
  override_with(arw_deg_sqrt_h, kDegPerSqrtHour, noise.gyro_noise_density);
  override_with(vrw_m_s_sqrt_h, kMPerSPerSqrtHour, noise.accel_noise_density);
  override_with(gyro_bias_deg_h, kDegPerHour, noise.gyro_bias_sigma);
  override_with(accel_bias_mgal, kMilliGal, noise.accel_bias_sigma);
  override_with(bias_tau_s, 1, noise.bias_tau);
  override_with(gyro_turn_on_deg_h, kDegPerHour, noise.gyro_turn_on_sigma);
  override_with(accel_turn_on_mgal, kMilliGal, noise.accel_turn_on_sigma);
  noise.learned = learned;
  return noise;
}

ImuOptions ImuOptions::completed_by(const ImuOptions& recorded) const {
  ImuOptions out = *this;
  if (samples == kAsRecorded) {
    out.samples = recorded.samples == kAsRecorded ? "interval_mean" : recorded.samples;
  }
  if (preset != kAsRecorded) return out;
  out.preset = recorded.preset == kAsRecorded ? kDefaultPreset : recorded.preset;
  for (const auto value :
       {&ImuOptions::arw_deg_sqrt_h, &ImuOptions::vrw_m_s_sqrt_h, &ImuOptions::gyro_bias_deg_h,
        &ImuOptions::accel_bias_mgal, &ImuOptions::bias_tau_s, &ImuOptions::gyro_turn_on_deg_h,
        &ImuOptions::accel_turn_on_mgal}) {
    if (!(out.*value)) out.*value = recorded.*value;
  }
  return out;
}

ImuOptions ImuOptions::with(const ImuNoise& noise) const {
  ImuOptions out = *this;
  out.arw_deg_sqrt_h = noise.gyro_noise_density / kDegPerSqrtHour;
  out.vrw_m_s_sqrt_h = noise.accel_noise_density / kMPerSPerSqrtHour;
  out.gyro_bias_deg_h = noise.gyro_bias_sigma / kDegPerHour;
  out.accel_bias_mgal = noise.accel_bias_sigma / kMilliGal;
  out.bias_tau_s = noise.bias_tau;
  out.gyro_turn_on_deg_h = noise.gyro_turn_on_sigma / kDegPerHour;
  out.accel_turn_on_mgal = noise.accel_turn_on_sigma / kMilliGal;
  out.learned = noise.learned;
  return out;
}

ImuOptions ImuOptions::scaled(double factor) const {
  ImuNoise n = noise();
  for (double* value : {&n.gyro_noise_density, &n.accel_noise_density, &n.gyro_bias_sigma,
                        &n.accel_bias_sigma, &n.gyro_turn_on_sigma, &n.accel_turn_on_sigma})
    *value *= factor;
  return with(n);
}

SampleKind ImuOptions::sample_kind() const {
  if (samples == "interval_mean" || samples == kAsRecorded) return SampleKind::interval_mean;
  if (samples == "instantaneous") return SampleKind::instantaneous;
  throw UsageError(
      fmt::format("imu.samples: unknown kind '{}'; use interval_mean or instantaneous", samples));
}

}  // namespace foucault::imu
