#include "foucault/diagnosis/acceleration_match.h"

#include <utility>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector2d;

constexpr double kSpacing = 0.95;           // [s] between fixes, 1 s but for jitter
constexpr double kLongest = 2.5;            // [s]; chosen
constexpr double kFewestPairs = 60;         // pairs; a correlation of noise is below 0.4 (3 sigmas)
constexpr double kLeastAcceleration = 0.2;  // [m/s^2], standard deviation; chosen: roads tilt it

}  // namespace

void AccelerationMatch::add(const ImuIncrement& increment) {
  force_ += (q_v_b_ * increment.dvel_b).head<2>();
  time_ += increment.dt();
}

void AccelerationMatch::add(const GnssFix& fix) {
  if (anchor_ && seconds_between(anchor_->t_ns, fix.t_ns) < kSpacing) return;
  const std::optional<GnssFix> before = std::exchange(anchor_, fix);
  const Vector2d mean = time_ > 0 ? Vector2d(force_ / time_) : force_;
  force_.setZero();
  time_ = 0;
  if (!before || seconds_between(before->t_ns, fix.t_ns) > kLongest) {
    last_speed_.reset();
    return;
  }
  const double dt = seconds_between(before->t_ns, fix.t_ns);
  const geodesy::LocalFrame frame(before->antenna);
  const double speed = frame.to_local(fix.antenna).head<2>().norm() / dt;
  // A change of mean speeds goes with the force about the fix between them.
  if (last_speed_) pair((speed - *last_speed_) / dt, 0.5 * (mean + last_mean_));
  last_speed_ = speed;
  last_mean_ = mean;
}

void AccelerationMatch::pair(double acceleration, const Vector2d& force) {
  n_ += 1;
  a_ += acceleration;
  aa_ += acceleration * acceleration;
  f_ += force;
  ff_ += force.cwiseAbs2();
  af_ += acceleration * force;
}

std::optional<Vector2d> AccelerationMatch::correlation() const {
  if (n_ < kFewestPairs) return std::nullopt;
  const double variance = aa_ / n_ - a_ * a_ / (n_ * n_);
  if (variance < kLeastAcceleration * kLeastAcceleration) return std::nullopt;
  const Vector2d covariance = af_ / n_ - a_ / n_ * f_ / n_;
  const Vector2d of_force = ff_ / n_ - (f_ / n_).cwiseAbs2();
  return Vector2d(covariance.cwiseQuotient((variance * of_force).cwiseMax(1e-12).cwiseSqrt()));
}

}  // namespace foucault::diagnosis
