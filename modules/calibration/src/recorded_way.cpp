#include "foucault/calibration/recorded_way.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/imu/increments.h"

namespace foucault::calibration {
namespace {

constexpr double kPiece = 0.0195;   // [s]: 20 ms and their jitter, as in the alignment
constexpr double kLongest = 1800;   // [s]
constexpr double kSettles = 60;     // [s]
constexpr double kMostBridged = 1;  // [s]
/// What a vehicle does instead in a hole, as GapOptions has it: 6 deg/s and 1 m/s^2.
constexpr double kHoleRate = 0.1, kHoleForce = 1;

bool is_finite(const ImuIncrement& increment) {
  return increment.dtheta_b.allFinite() && increment.dvel_b.allFinite();
}

}  // namespace

void WayRecorder::epoch(const state::Epoch& epoch) {
  if (!start_) start_ = epoch;
  if (settled_ || seconds_between(start_->t_ns, epoch.t_ns) < kSettles) return;
  settled_ = true;
  start_ = epoch;
}

void WayRecorder::add(const Measurement& measurement) {
  if (ended_) return;
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) add(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) fixes_.push_back(*fix);
}

void WayRecorder::add(const ImuIncrement& increment) {
  if (increment.dt() <= 0 || !is_finite(increment)) return;
  if (increments_.empty()) return increments_.push_back(increment);
  if (increment.t_begin_ns < increments_.back().t_end_ns) return;
  const double missing = seconds_between(increments_.back().t_end_ns, increment.t_begin_ns);
  const double since = seconds_between(increments_.front().t_begin_ns, increment.t_end_ns);
  ended_ = missing > kMostBridged || since > kLongest;
  if (ended_) return;
  if (missing > 0) bridge(increment);
  ImuIncrement& last = increments_.back();
  if (last.dt() + increment.dt() > kPiece) return increments_.push_back(increment);
  last.dtheta_b += increment.dtheta_b;
  last.dvel_b += increment.dvel_b;
  last.t_end_ns = increment.t_end_ns;
}

void WayRecorder::bridge(const ImuIncrement& next) {
  const ImuIncrement& last = increments_.back();
  ImuIncrement made_up;
  made_up.t_begin_ns = last.t_end_ns;
  made_up.t_end_ns = next.t_begin_ns;
  const double share = made_up.dt() / last.dt();
  made_up.dtheta_b = share * last.dtheta_b;
  made_up.dvel_b = share * last.dvel_b;
  made_up.extra_gyro_noise_density = kHoleRate * std::sqrt(made_up.dt());
  made_up.extra_accel_noise_density = kHoleForce * std::sqrt(made_up.dt());
  increments_.push_back(made_up);
}

std::optional<RecordedWay> WayRecorder::way() const {
  if (!start_) return std::nullopt;
  RecordedWay way;
  way.start = *start_;
  for (const ImuIncrement& increment : increments_) {
    if (increment.t_end_ns <= start_->t_ns) continue;
    way.increments.push_back(increment.t_begin_ns < start_->t_ns
                                 ? imu::split(increment, start_->t_ns).second
                                 : increment);
  }
  std::vector<int64_t> used = used_;
  std::sort(used.begin(), used.end());
  for (const GnssFix& fix : fixes_) {
    if (fix.t_ns <= start_->t_ns || !std::binary_search(used.begin(), used.end(), fix.t_ns))
      continue;
    way.fixes.push_back(fix);
    way.fixes.back().since_first_s = seconds_between(fixes_.front().t_ns, fix.t_ns);
  }
  std::stable_sort(way.fixes.begin(), way.fixes.end(),
                   [](const GnssFix& a, const GnssFix& b) { return a.t_ns < b.t_ns; });
  return way;
}

}  // namespace foucault::calibration
