#include "track.h"

#include <algorithm>

#include "foucault/core/time.h"
#include "foucault/imu/increments.h"

namespace foucault::alignment {
namespace {

constexpr double kPiece = 0.0195;     // [s]: 20 ms and their jitter; turns of vehicles are slower
constexpr double kFixSpacing = 0.19;  // [s]
constexpr std::size_t kFewestFixes = 3;  // for an acceleration

}  // namespace

Track::Track(double longest_s) : longest_ns_(nanoseconds(longest_s)) {}

void Track::add(const GnssFix& fix) {
  if (last_fix_ns_ && seconds_between(*last_fix_ns_, fix.t_ns) < kFixSpacing) return;
  last_fix_ns_ = fix.t_ns;
  waiting_.push_back(fix);
}

std::vector<Step> Track::add(const ImuIncrement& increment) {
  std::vector<Step> complete;
  ImuIncrement rest = increment;
  if (end_ns_ && rest.t_begin_ns > *end_ns_) {  // what is missing goes on as what follows
    rest = imu::begun_at(rest, *end_ns_);
  }
  while (!waiting_.empty() && waiting_.front().t_ns <= rest.t_end_ns) {
    const GnssFix fix = waiting_.front();
    waiting_.pop_front();
    if (fix.t_ns < rest.t_begin_ns) continue;  // before the IMU, or late
    if (fix.t_ns == rest.t_end_ns) {
      append(rest, complete);
      rest.t_begin_ns = rest.t_end_ns;
    } else if (fix.t_ns > rest.t_begin_ns) {
      const auto [until, after] = imu::split(rest, fix.t_ns);
      append(until, complete);
      rest = after;
    }
    close_piece(complete);
    keep(fix, complete);
  }
  if (rest.t_end_ns > rest.t_begin_ns) append(rest, complete);
  const int64_t earliest_ns = increment.t_end_ns - longest_ns_;
  while (!steps_.empty() &&
         std::visit([](const auto& s) { return stamp(s); }, steps_.front()) < earliest_ns)
    steps_.pop_front();
  return complete;
}

void Track::append(const ImuIncrement& increment, std::vector<Step>& complete) {
  if (piece_.t_end_ns == piece_.t_begin_ns) piece_.t_begin_ns = increment.t_begin_ns;
  piece_.t_end_ns = increment.t_end_ns;
  piece_.dtheta_b += increment.dtheta_b;
  piece_.dvel_b += increment.dvel_b;
  end_ns_ = increment.t_end_ns;
  if (piece_.dt() >= kPiece) close_piece(complete);
}

void Track::close_piece(std::vector<Step>& complete) {
  if (piece_.t_end_ns > piece_.t_begin_ns) keep(piece_, complete);
  piece_ = ImuIncrement();
}

void Track::keep(const Step& step, std::vector<Step>& complete) {
  steps_.push_back(step);
  complete.push_back(step);
}

std::vector<GnssFix> Track::first_fixes(double shortest_s, int64_t from_ns) const {
  std::vector<GnssFix> fixes;
  for (const Step& step : steps_) {
    const auto* fix = std::get_if<GnssFix>(&step);
    if (!fix || fix->t_ns < from_ns) continue;
    fixes.push_back(*fix);
    if (fixes.size() >= kFewestFixes &&
        seconds_between(fixes.front().t_ns, fix->t_ns) >= shortest_s)
      break;
  }
  return fixes;
}

void Track::forget_until(int64_t t_ns) {
  while (!steps_.empty() &&
         std::visit([](const auto& s) { return stamp(s); }, steps_.front()) <= t_ns)
    steps_.pop_front();
}

Eigen::Vector3d Track::mean_force_b() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double T = 0;
  for (const Step& step : steps_) {
    const auto* increment = std::get_if<ImuIncrement>(&step);
    if (!increment) continue;
    sum += increment->dvel_b;
    T += increment->dt();
  }
  return T > 0 ? Eigen::Vector3d(sum / T) : sum;
}

int64_t Track::begin_ns() const {
  for (const Step& step : steps_) {
    if (const auto* increment = std::get_if<ImuIncrement>(&step)) return increment->t_begin_ns;
  }
  return end_ns_.value_or(INT64_MIN);
}

}  // namespace foucault::alignment
