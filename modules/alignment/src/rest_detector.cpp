#include "rest_detector.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {

namespace {

constexpr double kBlock = 1.0;                 // [s]
constexpr double kSteadyGyro = 0.3 * kDegree;  // [rad/s]
constexpr double kSteadyAccel = 0.08;          // [m/s^2]
constexpr std::size_t kRecentBlocks = 20;
constexpr int kDisturbedBlocks = 3;        // more end the rest
constexpr double kStandingSpeed = 0.2;     // [m/s], beyond 3 sigma
constexpr double kStandingDistance = 0.1;  // [m], beyond 4 sigma

/// Variance of a mean, given the difference of the means of the two halves. White noise makes that
/// difference of twice the sigma of the mean; what is far beyond is drift, and as much as the
/// difference does the mean then miss the ends.
Eigen::Vector3d with_drift(const Eigen::Vector3d& variance, const Eigen::Vector3d& change) {
  Eigen::Vector3d result = variance;
  for (int axis = 0; axis < 3; ++axis) {
    const double squared = change[axis] * change[axis];
    if (squared > 9 * 4 * variance[axis]) result[axis] = squared;
  }
  return result;
}

}  // namespace

RestDetector::RestDetector(double min_rest_s, double max_rest_s)
    : min_blocks_(static_cast<std::size_t>(std::max(2.0, std::ceil(min_rest_s / kBlock)))),
      max_rest_ns_(nanoseconds(max_rest_s)) {}

void RestDetector::add(const GnssFix& fix) {
  if (ended_) return;
  if (moved(fix)) {
    if (established()) {
      ended_ = true;
      return;
    }
    begin_anew(fix.t_ns);
  }
  fixes_.push_back(fix);
}

bool RestDetector::moved(const GnssFix& fix) const {
  if (fix.velocity_n && fix.velocity_covariance.allFinite()) {
    const double speed = fix.velocity_n->head<2>().norm();
    if (speed > 3 * geodesy::horizontal_sigma(fix.velocity_covariance) + kStandingSpeed)
      return true;
  }
  if (fixes_.empty()) return false;
  const GnssFix& first = fixes_.front();
  const Eigen::Vector3d way = geodesy::LocalFrame(first.antenna).to_local(fix.antenna);
  const double sigma = std::hypot(geodesy::horizontal_sigma(fix.position_covariance),
                                  geodesy::horizontal_sigma(first.position_covariance));
  return way.head<2>().norm() > 4 * sigma + kStandingDistance;
}

bool RestDetector::add(const ImuIncrement& increment) {
  if (block_.begin_ns == block_.end_ns) block_.begin_ns = increment.t_begin_ns;
  block_.end_ns = increment.t_end_ns;
  block_.gyro_b += increment.dtheta_b;
  block_.accel_b += increment.dvel_b;
  if (seconds_between(block_.begin_ns, block_.end_ns) < kBlock) return false;
  const std::size_t before = blocks_.size();
  end_block();
  forget_before(increment.t_end_ns - max_rest_ns_);
  return !ended_ && blocks_.size() > before;
}

void RestDetector::end_block() {
  RestBlock block = block_;
  block_ = RestBlock();
  if (ended_) return;
  const double length = seconds_between(block.begin_ns, block.end_ns);
  block.gyro_b /= length;
  block.accel_b /= length;
  if (is_still(block)) {
    disturbed_ = 0;
  } else if (established()) {
    ended_ = ++disturbed_ > kDisturbedBlocks;
    return;
  } else {
    begin_anew(block.begin_ns);
  }
  blocks_.push_back(block);
}

bool RestDetector::is_still(const RestBlock& block) const {
  if (blocks_.empty()) return true;
  const RestMeans rest = means();
  return (block.gyro_b - rest.gyro_b).cwiseAbs().maxCoeff() < kSteadyGyro &&
         (block.accel_b - rest.accel_b).cwiseAbs().maxCoeff() < kSteadyAccel;
}

void RestDetector::begin_anew(int64_t begin_ns) {
  blocks_.clear();
  disturbed_ = 0;
  while (!fixes_.empty() && fixes_.front().t_ns < begin_ns) fixes_.pop_front();
}

/// Bounds the memory: the rest's beginning slides along, a rest that is over and too old goes.
void RestDetector::forget_before(int64_t earliest_ns) {
  while (!blocks_.empty() && blocks_.front().begin_ns < earliest_ns) blocks_.pop_front();
  while (!fixes_.empty() && fixes_.front().t_ns < earliest_ns) fixes_.pop_front();
  if (ended_ && !established()) {
    begin_anew(block_.begin_ns);
    ended_ = false;
  }
}

bool RestDetector::established() const {
  const std::size_t needed = min_blocks_ + (ended_ ? 1 : 0);
  if (blocks_.size() < needed || fixes_.size() < 2) return false;
  const int64_t confirmed_ns = fixes_.back().t_ns - fixes_.front().t_ns;
  return confirmed_ns >= nanoseconds(0.5 * kBlock * static_cast<double>(min_blocks_));
}

std::size_t RestDetector::blocks_used() const {
  return blocks_.size() > 1 && ended_ ? blocks_.size() - 1 : blocks_.size();
}

RestMeans RestDetector::means() const { return means_over(0, blocks_used()); }

RestMeans RestDetector::recent_means() const {
  const std::size_t n = blocks_used();
  return means_over(n > kRecentBlocks ? n - kRecentBlocks : 0, n);
}

RestMeans RestDetector::means_over(std::size_t first, std::size_t last) const {
  const double n = static_cast<double>(last - first);
  RestMeans rest;
  rest.begin_ns = blocks_[first].begin_ns;
  rest.end_ns = blocks_[last - 1].end_ns;
  for (std::size_t i = first; i < last; ++i) {
    rest.gyro_b += blocks_[i].gyro_b / n;
    rest.accel_b += blocks_[i].accel_b / n;
  }
  if (last - first < 2) return rest;
  Eigen::Vector3d gyro_change = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_change = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector3d gyro = blocks_[i].gyro_b - rest.gyro_b;
    const Eigen::Vector3d accel = blocks_[i].accel_b - rest.accel_b;
    rest.gyro_variance += gyro.cwiseAbs2() / (n * (n - 1));
    rest.accel_variance += accel.cwiseAbs2() / (n * (n - 1));
    const double half = 2 * (i - first) < last - first ? -2 / n : 2 / n;
    gyro_change += half * gyro;
    accel_change += half * accel;
  }
  rest.gyro_variance = with_drift(rest.gyro_variance, gyro_change);
  rest.accel_variance = with_drift(rest.accel_variance, accel_change);
  return rest;
}

std::optional<GnssFix> RestDetector::first_fix() const {
  const RestMeans rest = means();
  for (const GnssFix& fix : fixes_) {
    if (fix.t_ns >= rest.begin_ns && fix.t_ns <= rest.end_ns) return fix;
  }
  return std::nullopt;
}

int64_t RestDetector::begin_ns() const {
  return blocks_.empty() ? block_.begin_ns : blocks_.front().begin_ns;
}

}  // namespace foucault::alignment
