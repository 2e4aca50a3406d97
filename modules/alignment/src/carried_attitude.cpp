#include "carried_attitude.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::alignment {

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kGyroScaleSigma = 0.003;  // of the angle turned: scale factor, misalignment
constexpr double kSpeedChecked = 30;       // [s] that integrated accelerometers tell the direction
constexpr double kReversing = -1.0;        // [m/s]

/// Level attitude with the forward axis at azimuth zero.
Quaterniond level(const Vector3d& specific_force_b, const Vector3d& forward_b) {
  const Quaterniond q = Quaterniond::FromTwoVectors(specific_force_b, Vector3d(-Vector3d::UnitZ()));
  const double turned = geodesy::azimuth(q * forward_b);
  return Quaterniond(Eigen::AngleAxisd(-turned, Vector3d::UnitZ())) * q;
}

}  // namespace

/// At rest the gyroscopes show their bias and the Earth's rate. Which way the horizontal part of
/// the latter points is not known yet and it counts as bias; the vertical part turns the heading.
void CarriedAttitude::rest(const RestMeans& means, double latitude, const imu::ImuNoise& noise) {
  attitude_.forward_b = forward_b_;
  attitude_.q_l_b = level(means.accel_b, forward_b_);
  earth_rate_z_ = geodesy::wgs84::earth_rate_n(latitude).z();
  bias_ = means.gyro_b - attitude_.q_l_b.conjugate() * Vector3d(0, 0, earth_rate_z_);
  gravity_ = means.accel_b.norm();
  velocity_l_.setZero();
  since_rest_ = 0;
  turned_ = 0;
  noise_density_ = noise.gyro_noise_density;
  const double white = noise_density_ * noise_density_ / std::max(1.0, means.duration());
  bias_variance_ = std::max(white, means.gyro_variance.maxCoeff());
}

void CarriedAttitude::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  const Vector3d earth_b = attitude_.q_l_b.conjugate() * Vector3d(0, 0, earth_rate_z_);
  const Vector3d dtheta = increment.dtheta_b - (bias_ + earth_b) * dt;
  velocity_l_ +=
      attitude_.q_l_b * so3::exp(0.5 * dtheta) * increment.dvel_b + Vector3d(0, 0, gravity_ * dt);
  turned_ += (attitude_.q_l_b * dtheta).z();
  attitude_.q_l_b = (attitude_.q_l_b * so3::exp(dtheta)).normalized();
  attitude_.omega_b = dtheta / dt;
  since_rest_ += dt;
}

double CarriedAttitude::drift_variance() const {
  const double bias = bias_variance_ * since_rest_ * since_rest_;
  const double white = noise_density_ * noise_density_ * since_rest_;
  const double scale = kGyroScaleSigma * turned_;
  return bias + white + scale * scale;
}

bool CarriedAttitude::reverses() const {
  if (since_rest_ > kSpeedChecked) return false;
  const Vector3d forward_l = attitude_.q_l_b * forward_b_;
  return velocity_l_.head<2>().dot(forward_l.head<2>()) < kReversing;
}

}  // namespace foucault::alignment
