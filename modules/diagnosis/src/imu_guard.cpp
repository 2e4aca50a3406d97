#include "foucault/diagnosis/imu_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/imu/increments.h"

namespace foucault::diagnosis {
namespace {

// Chosen, on simulated clipping: at rest a coarse sensor repeats its
// value at will, so a few repeats count only beyond what rest shows, 5 deg/s and gravity with its
// offset. In motion the last of 16 bits is noise: five equal values in a row are one in 10^4 at a
// noise of two digits, twenty less than one in 10^16.
constexpr double kLargeRate = 0.09;  // [rad/s]
constexpr double kLargeForce = 12;   // [m/s^2]
constexpr int kClipped = 5;          // samples
constexpr int kStuck = 20;           // samples
constexpr double kStuckFor = 0.5;    // [s]
constexpr double kSame = 1e-9;       // relative: rates come as increments over rounded times
// By KITTI, whose eight splices of 1.5 s bend by rounding alone. Where noise bends each rate, ten
// samples with all six bends below a hundredth of the usual one are less
// likely than 10^-100.
constexpr double kStraight = 0.01;
constexpr int64_t kUsualMemory = 200;     // samples: the mean bend to 5 %
constexpr int kInterpolated = 10;         // samples
constexpr double kInterpolatedFor = 0.1;  // [s]

}  // namespace

void ImuGuard::Axis::add(double rate, double dt) {
  if (std::abs(rate - value) <= kSame * std::abs(value)) {
    ++repeats;
    repeated_s += dt;
    changed_s = 0;
  } else {
    value = rate;
    repeats = 0;
    repeated_s = 0;
    changed_s += dt;
  }
}

void ImuGuard::add(const Eigen::Vector3d& rate, double dt, Triad& triad) {
  for (std::size_t i = 0; i < 3; ++i) triad[i].add(rate[static_cast<int>(i)], dt);
}

std::optional<int> ImuGuard::repeating(const Triad& triad, double large) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = triad[i];
    const Axis& a = triad[(i + 1) % 3];
    const Axis& b = triad[(i + 2) % 3];
    const bool alone = std::max(a.changed_s, b.changed_s) >= axis.repeated_s;
    const bool clipped = std::abs(axis.value) > large && axis.repeats >= kClipped;
    const bool stuck = axis.repeats >= kStuck && axis.repeated_s >= kStuckFor;
    if (alone && (clipped || stuck)) return static_cast<int>(i);
  }
  return std::nullopt;
}

void ImuGuard::Line::add(const Rates& rates, double dt) {
  const Rates step = rates - last_;
  const Rates bend = step - step_;
  last_ = rates;
  step_ = step;
  if (goes_on(bend, step)) {
    ++straight_;
    straight_s_ += dt;
    return;
  }
  straight_ = 0;
  straight_s_ = 0;
  ++known_;
  const double share = 1 / static_cast<double>(std::min(known_, kUsualMemory));
  usual_ += share * (bend.cwiseAbs() - usual_);
  usual_square_ += share * (bend.cwiseAbs2() - usual_square_);
}

/// A line that stands still is rest, or stuck. Rates that bend only here and there have no noise to
/// miss; that of noise is 0.8 of its root mean square.
bool ImuGuard::Line::goes_on(const Rates& bend, const Rates& step) const {
  constexpr Eigen::Index kSloped = 3;  // axes
  constexpr double kNoise = 0.2;
  return known_ >= kUsualMemory && (step.array() != 0).count() >= kSloped &&
         (bend.array().abs() < kStraight * usual_.array()).all() &&
         (usual_.array().square() > kNoise * kNoise * usual_square_.array()).all();
}

bool ImuGuard::Line::is_interpolated() const {
  return straight_ >= kInterpolated && straight_s_ >= kInterpolatedFor;
}

/// Gyroscopes measure up to 70 rad/s (4000 deg/s), shock sensors up to 2e4 m/s^2; more is a bit
/// that fell over. Units that are wrong by less are for Plausibility.
bool ImuGuard::is_measurable(const ImuIncrement& increment) {
  constexpr double kFastest = 1000;   // [rad/s]
  constexpr double kStrongest = 1e5;  // [m/s^2]
  const double dt = std::abs(increment.dt());
  return increment.dtheta_b.allFinite() && increment.dvel_b.allFinite() &&
         increment.dtheta_b.norm() <= kFastest * dt && increment.dvel_b.norm() <= kStrongest * dt;
}

ImuGuard::Verdict ImuGuard::look_at(const ImuIncrement& increment) {
  Verdict verdict;
  ++seen_;
  if (!is_measurable(increment)) {
    not_finite_.add(increment.t_end_ns);
    return verdict;
  }
  const int64_t before_ns = last_end_ns_.value_or(increment.t_begin_ns);
  if (increment.t_end_ns <= std::max(before_ns, increment.t_begin_ns)) {
    disordered_.add(increment.t_end_ns);
    return verdict;
  }
  last_end_ns_ = increment.t_end_ns;
  verdict.increment =
      increment.t_begin_ns < before_ns ? imu::split(increment, before_ns).second : increment;

  const double dt = increment.dt();
  add(increment.dtheta_b / dt, dt, gyro_);
  add(increment.dvel_b / dt, dt, accel_);
  const std::optional<int> gyro = repeating(gyro_, kLargeRate);
  const std::optional<int> accel = repeating(accel_, kLargeForce);
  verdict.accel_repeats = accel.has_value();
  Line::Rates rates;
  rates << increment.dtheta_b / dt, increment.dvel_b / dt;
  line_.add(rates, dt);
  if (line_.is_interpolated()) {
    interpolated_.add(increment.t_end_ns);
    verdict.increment.reset();
  }
  if (gyro) {
    repeated_.add(increment.t_end_ns);
    verdict.increment.reset();
  }
  if ((gyro || accel) && !noticed_) {
    noticed_ = true;
    const int axis = gyro ? *gyro : *accel;
    verdict.notice =
        fmt::format("{} axis {} repeats one value at {}, clipped or stuck; such samples {}",
                    gyro ? "gyroscope" : "accelerometer", "xyz"[axis], utc_text(increment.t_end_ns),
                    gyro ? "are left out" : "get more noise");
  }
  return verdict;
}

std::vector<std::string> ImuGuard::summary() const {
  std::vector<std::string> lines;
  if (not_finite_.count > 0) {
    lines.push_back(
        fmt::format("{} IMU samples are not finite, or beyond what any sensor measures, and were "
                    "left out, the first at {}",
                    not_finite_.count, utc_text(not_finite_.first_ns)));
  }
  if (disordered_.count > 0) {
    lines.push_back(
        fmt::format("{} IMU samples do not come after the one before them and were "
                    "left out, the first at {}",
                    disordered_.count, utc_text(disordered_.first_ns)));
  }
  if (repeated_.count > 0) {
    lines.push_back(
        fmt::format("{} IMU samples of a gyroscope that was clipped or stuck were left "
                    "out, the first at {}",
                    repeated_.count, utc_text(repeated_.first_ns)));
  }
  if (interpolated_.count > 0) {
    lines.push_back(fmt::format(
        "{} IMU samples lie on straight lines, interpolated over lost data, and were left out, the "
        "first at {}",
        interpolated_.count, utc_text(interpolated_.first_ns)));
  }
  return lines;
}

}  // namespace foucault::diagnosis
