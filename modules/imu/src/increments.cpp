#include "foucault/imu/increments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "foucault/core/error.h"
#include "foucault/core/hole.h"
#include "foucault/core/time.h"

namespace foucault::imu {

namespace {

constexpr std::size_t kRememberedIntervals = 25;
/// So many intervals make the median trustworthy whatever its value; fewer do only if it is one
/// that an IMU may have, so that a log beginning with a hole does not teach it.
constexpr std::size_t kTrustedIntervals = 3;
constexpr int64_t kLongestPlausibleIntervalNs = kNanosecondsPerSecond / 10;

void check_sample(const ImuSample& sample, const std::optional<ImuSample>& last) {
  if (!sample.gyro_b.allFinite() || !sample.accel_b.allFinite()) {
    throw DataError(fmt::format("IMU sample at {} is not finite; remove it from the log",
                                utc_text(sample.t_ns)));
  }
  if (last && sample.t_ns <= last->t_ns) {
    throw DataError(
        fmt::format("IMU stamp {} does not come after the one before it, {}; sort the "
                    "samples by time and remove duplicates",
                    utc_text(sample.t_ns), utc_text(last->t_ns)));
  }
}

}  // namespace

Incrementer::Incrementer(SampleKind kind) : kind_(kind) { recent_.reserve(kRememberedIntervals); }

std::optional<ImuIncrement> Incrementer::add(const ImuSample& sample) {
  check_sample(sample, last_);
  if (!last_) {
    last_ = sample;
    return std::nullopt;
  }
  const ImuSample previous = *last_;
  last_ = sample;
  const int64_t interval_ns = sample.t_ns - previous.t_ns;
  learn_interval(interval_ns);
  if (!interval_known()) return std::nullopt;

  const bool hole = is_hole(interval_ns, nominal_ns_);
  const bool trapezoid = kind_ == SampleKind::instantaneous && !hole;
  ImuIncrement increment;
  increment.t_begin_ns = hole ? sample.t_ns - nominal_ns_ : previous.t_ns;
  increment.t_end_ns = sample.t_ns;
  const Eigen::Vector3d rate =
      trapezoid ? Eigen::Vector3d(0.5 * (previous.gyro_b + sample.gyro_b)) : sample.gyro_b;
  const Eigen::Vector3d force =
      trapezoid ? Eigen::Vector3d(0.5 * (previous.accel_b + sample.accel_b)) : sample.accel_b;
  increment.dtheta_b = rate * increment.dt();
  increment.dvel_b = force * increment.dt();
  return increment;
}

void Incrementer::learn_interval(int64_t interval_ns) {
  if (recent_.size() < kRememberedIntervals) {
    recent_.push_back(interval_ns);
  } else {
    recent_[next_] = interval_ns;
    next_ = (next_ + 1) % kRememberedIntervals;
  }
  std::array<int64_t, kRememberedIntervals> sorted{};
  const auto end = std::copy(recent_.begin(), recent_.end(), sorted.begin());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(recent_.size() / 2);
  std::nth_element(sorted.begin(), middle, end);
  nominal_ns_ = *middle;
}

bool Incrementer::interval_known() const {
  return recent_.size() >= kTrustedIntervals || nominal_ns_ <= kLongestPlausibleIntervalNs;
}

std::pair<ImuIncrement, ImuIncrement> split(const ImuIncrement& increment, int64_t t_ns) {
  if (t_ns <= increment.t_begin_ns || t_ns >= increment.t_end_ns) {
    throw std::invalid_argument(
        fmt::format("split: stamp {} ns is not inside the increment from {} ns to {} ns", t_ns,
                    increment.t_begin_ns, increment.t_end_ns));
  }
  ImuIncrement first = increment;
  ImuIncrement second = increment;
  first.t_end_ns = t_ns;
  second.t_begin_ns = t_ns;
  const double fraction = static_cast<double>(t_ns - increment.t_begin_ns) /
                          static_cast<double>(increment.t_end_ns - increment.t_begin_ns);
  first.dtheta_b = fraction * increment.dtheta_b;
  first.dvel_b = fraction * increment.dvel_b;
  second.dtheta_b = increment.dtheta_b - first.dtheta_b;
  second.dvel_b = increment.dvel_b - first.dvel_b;
  return {first, second};
}

ImuIncrement begun_at(const ImuIncrement& increment, int64_t t_ns) {
  ImuIncrement longer = increment;
  longer.t_begin_ns = t_ns;
  const double stretch = longer.dt() / increment.dt();
  longer.dtheta_b *= stretch;
  longer.dvel_b *= stretch;
  return longer;
}

Eigen::Vector3d rotation_with_coning(const Eigen::Vector3d& previous_dtheta,
                                     const Eigen::Vector3d& dtheta) {
  return dtheta + previous_dtheta.cross(dtheta) / 12;
}

Eigen::Vector3d velocity_with_sculling(const Eigen::Vector3d& previous_dtheta,
                                       const Eigen::Vector3d& previous_dvel,
                                       const Eigen::Vector3d& dtheta, const Eigen::Vector3d& dvel) {
  return dvel + dtheta.cross(0.5 * dvel + dtheta.cross(dvel) / 6) +
         (previous_dtheta.cross(dvel) + previous_dvel.cross(dtheta)) / 12;
}

}  // namespace foucault::imu
