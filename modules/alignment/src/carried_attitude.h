#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "course_finder.h"
#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "rest_detector.h"

namespace foucault::alignment {

/// Carries the attitude from a rest through the drive by the gyroscopes, in a level frame l in
/// which the vehicle headed along azimuth 0 at rest.
class CarriedAttitude {
 public:
  explicit CarriedAttitude(const Eigen::Vector3d& forward_b) : forward_b_(forward_b) {}

  /// Levels by the means of a rest, which ends now, and takes the gyroscope bias from them.
  void rest(const RestMeans& means, double latitude, const imu::ImuNoise& noise);
  void add(const ImuIncrement& increment);

  const LevelAttitude& attitude() const { return attitude_; }
  double since_rest() const { return since_rest_; }  ///< [s]

  /// Variance of the azimuth's change since the rest [rad^2]: bias, white noise, scale factor.
  double drift_variance() const;

  /// Whether the vehicle goes backwards, as far as the accelerometers can tell.
  bool reverses() const;

 private:
  Eigen::Vector3d forward_b_;
  LevelAttitude attitude_;
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();        ///< [rad/s]
  Eigen::Vector3d velocity_l_ = Eigen::Vector3d::Zero();  ///< since the rest [m/s]
  double earth_rate_z_ = 0;                               ///< [rad/s]
  double gravity_ = 0;                                    ///< as the accelerometers felt it [m/s^2]
  double since_rest_ = 0;
  double turned_ = 0;         ///< about the vertical [rad]
  double bias_variance_ = 0;  ///< [(rad/s)^2]
  double noise_density_ = 0;  ///< [rad/s/sqrt(Hz)]
};

}  // namespace foucault::alignment
