#pragma once

#include <string>
#include <vector>

#include "foucault/core/config.h"

namespace foucault::imu {

/// Error model of an IMU, paper (31)-(32): white noise, and biases that are first-order
/// Gauss-Markov processes about an unknown turn-on value.
struct ImuNoise {
  double gyro_noise_density = 0;   ///< [rad/s/sqrt(Hz)]
  double accel_noise_density = 0;  ///< [m/s^2/sqrt(Hz)]
  double gyro_bias_sigma = 0;      ///< steady state, 1 sigma [rad/s]
  double accel_bias_sigma = 0;     ///< [m/s^2]
  double bias_tau = 3600;          ///< correlation time [s]
  double gyro_turn_on_sigma = 0;   ///< [rad/s]
  double accel_turn_on_sigma = 0;  ///< [m/s^2]
  /// White noise and biases are those that a whole recording shows, or does not contradict.
  bool learned = false;

  /// Power of the driving noise, q = 2 sigma^2 / tau [(rad/s)^2/s], [(m/s^2)^2/s].
  double gyro_bias_power() const { return 2 * gyro_bias_sigma * gyro_bias_sigma / bias_tau; }
  double accel_bias_power() const { return 2 * accel_bias_sigma * accel_bias_sigma / bias_tau; }
};

/// A bias as one state: the first-order Gauss-Markov process that has the variance of turn-on value
/// and variation together, and the driving noise of the variation, q = 2 sigma^2 / tau. What is
/// constant does not decay: the larger the turn-on value, the longer its correlation time.
struct MarkovBias {
  double sigma;  ///< steady state; unit of the sensor
  double tau;    ///< [s]; infinite for a constant
};
MarkovBias gyro_markov_bias(const ImuNoise& noise);
MarkovBias accel_markov_bias(const ImuNoise& noise);

/// How samples in a log are to be read: rates at the stamp, or increments over the interval that
/// ends at the stamp, divided by its length.
enum class SampleKind { instantaneous, interval_mean };

/// Section `imu` of the configuration. A preset gives every value; a key that is set overrides its
/// value. Units in the keys are those of data sheets.
class ImuOptions : public Configurable {
 public:
  /// Of `preset` and `samples`: what the log says; else an ADIS16465, and means over intervals.
  static constexpr const char* kAsRecorded = "as_recorded";

  std::string preset = kAsRecorded;
  std::string samples = kAsRecorded;
  std::optional<double> arw_deg_sqrt_h, vrw_m_s_sqrt_h, gyro_bias_deg_h, accel_bias_mgal,
      bias_tau_s, gyro_turn_on_deg_h, accel_turn_on_mgal;
  bool learned = false;  ///< as ImuNoise; no key

  void fields(ConfigFields& f) override;

  /// The preset with the overrides, in SI. Throws UsageError for an unknown preset.
  ImuNoise noise() const;
  SampleKind sample_kind() const;

  /// With what a log says of its IMU, where this leaves it to the log; the noise as a whole, unless
  /// a preset is chosen here. Nothing is as recorded then.
  ImuOptions completed_by(const ImuOptions& recorded) const;

  /// The same with this noise.
  ImuOptions with(const ImuNoise& noise) const;

  /// The same with every sigma and noise density `factor` times as large.
  ImuOptions scaled(double factor) const;
};

/// Names of the presets, in the order shown to users.
std::vector<std::string> imu_preset_names();
/// Throws UsageError naming the known ones.
ImuNoise imu_preset(const std::string& name);

}  // namespace foucault::imu
