#include "given_start.h"

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void GivenStart::add(const ImuIncrement& increment) {
  rate_sum_ += increment.dtheta_b;
  rate_time_ += increment.dt();
  if (!imu_begin_ns_) imu_begin_ns_ = increment.t_begin_ns;
  if (first_ && first_->t_ns < *imu_begin_ns_) first_.reset();
}

std::optional<state::Epoch> GivenStart::add(const GnssFix& fix, const state::Mounting& mounting,
                                            const GivenAngles& given, const imu::ImuNoise& noise) {
  const bool covered = imu_begin_ns_ && first_;
  const GnssFix start = covered ? *first_ : fix;
  const Vector3d omega_b =
      rate_time_ > 0 ? Vector3d(rate_sum_ / rate_time_) : Vector3d(Vector3d::Zero());
  if (start.velocity_n && imu_begin_ns_) {
    return given_state(start, *start.velocity_n, start.velocity_covariance, omega_b, mounting.q_v_b,
                       given, noise);
  }
  if (!covered) {
    first_ = fix;
    rate_sum_.setZero();
    rate_time_ = 0;
    return std::nullopt;
  }
  constexpr double kAcceleration = 1.5;  // [m/s^2] within the interval
  const double dt = seconds_between(start.t_ns, fix.t_ns);
  if (dt <= 0) return std::nullopt;
  const Vector3d velocity_n = geodesy::LocalFrame(start.antenna).to_local(fix.antenna) / dt;
  const double unknown = kAcceleration * dt / 2;
  const Matrix3d covariance = (start.position_covariance + fix.position_covariance) / (dt * dt) +
                              unknown * unknown * Matrix3d::Identity();
  return given_state(start, velocity_n, covariance, omega_b, mounting.q_v_b, given, noise);
}

}  // namespace foucault::alignment
