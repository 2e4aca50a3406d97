#include "foucault/diagnosis/fix_doubt.h"

#include "foucault/core/time.h"
#include "foucault/diagnosis/innovation_monitor.h"
#include "foucault/diagnosis/reacquisition.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"

namespace foucault::diagnosis {
namespace {

// Chosen: true jumps are to be believed after a minute or so (31 s are measured), fixes that come
// once in half a minute are still a sequence, and a few lost samples (0.2 s, as where a run names a
// hole) leave the velocity known to cm/s.
constexpr double kLongestDoubt = 90;     // [s]
constexpr double kNoMoreFixes = 30;      // [s]
constexpr double kNoticeableHole = 0.2;  // [s], in the IMU

/// At the same rates.
ImuIncrement stretched_back(const ImuIncrement& increment, int64_t begin_ns) {
  ImuIncrement out = increment;
  out.t_begin_ns = begin_ns;
  const double factor = out.dt() / increment.dt();
  out.dtheta_b *= factor;
  out.dvel_b *= factor;
  return out;
}

DoubtBegin begin_at(const measurement::Navigator& navigator, const GnssFix& fix) {
  const state::Innovation innovation = navigator.innovation(measurement::GnssPosition(fix));
  return {navigator.epoch(), innovation.value, innovation.covariance.diagonal()};
}

}  // namespace

FixDoubt::FixDoubt(const GnssOptions& options, const FixJudge& judge,
                   const measurement::Navigator& navigator, const GnssFix& fix, bool returns)
    : ahead_(navigator), time_ns_(fix.t_ns), last_fix_ns_(fix.t_ns) {
  DoubtBegin begin = begin_at(navigator, fix);
  begin_ns_ = begin.state.t_ns;
  if (returns) {
    exclusion_ = std::make_unique<Reacquisition>(judge, std::move(begin), navigator, fix, ahead_);
  } else {
    exclusion_ = std::make_unique<InnovationMonitor>(options, judge, std::move(begin), ahead_);
  }
  meet(fix);
}

bool FixDoubt::add(const Measurement& measurement) {
  if (exclusion_->is_decided()) return true;
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) add_increment(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    if (fix->t_ns > time_ns_) waiting_.emplace(fix->t_ns, *fix);
    if (fix->t_ns == time_ns_) meet(*fix);
  }
  return exclusion_->is_decided();
}

void FixDoubt::add_increment(const ImuIncrement& increment) {
  if (increment.t_end_ns <= time_ns_) return;
  ImuIncrement rest = increment;
  if (rest.t_begin_ns < time_ns_) rest = imu::split(rest, time_ns_).second;
  if (seconds_between(time_ns_, rest.t_begin_ns) > kNoticeableHole) return exclusion_->settle();
  if (rest.t_begin_ns > time_ns_) rest = stretched_back(rest, time_ns_);
  while (!exclusion_->is_decided() && !waiting_.empty() &&
         waiting_.begin()->first <= increment.t_end_ns) {
    const GnssFix fix = waiting_.begin()->second;
    waiting_.erase(waiting_.begin());
    rest = drive_to(fix.t_ns, rest);
    meet(fix);
  }
  if (exclusion_->is_decided()) return;
  if (rest.t_end_ns > time_ns_) propagate(rest);
  if (seconds_between(last_fix_ns_, time_ns_) > kNoMoreFixes) exclusion_->settle();
}

/// Returns what is left of the increment, which is the increment itself if it ends there.
ImuIncrement FixDoubt::drive_to(int64_t t_ns, const ImuIncrement& increment) {
  if (t_ns <= time_ns_) return increment;
  if (t_ns == increment.t_end_ns) {
    propagate(increment);
    return increment;
  }
  const auto [before, after] = imu::split(increment, t_ns);
  propagate(before);
  return after;
}

void FixDoubt::propagate(const ImuIncrement& increment) {
  ahead_.propagate(increment);
  exclusion_->propagate(increment);
  time_ns_ = increment.t_end_ns;
}

void FixDoubt::meet(const GnssFix& fix) {
  const state::Innovation innovation =
      ahead_.navigator().innovation(measurement::GnssPosition(fix));
  MetFix met;
  met.fix = fix;
  met.innovation_n = innovation.value;
  met.innovation_covariance = innovation.covariance;
  met.square = mahalanobis_squared(met.innovation_n, met.innovation_covariance);
  met.since_last = seconds_between(last_fix_ns_, fix.t_ns);
  last_fix_ns_ = fix.t_ns;
  const bool too_long = seconds_between(begin_ns_, fix.t_ns) > kLongestDoubt;
  return too_long ? exclusion_->give_up(fix) : exclusion_->meet(met);
}

DoubtOutcome FixDoubt::outcome() {
  exclusion_->settle();
  return exclusion_->outcome();
}

}  // namespace foucault::diagnosis
