#include "intake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"

namespace foucault::navigation {

namespace {

/// Fixes further from the IMU in time are of another recording, or of another clock.
constexpr int64_t kElsewhenNs = 3600 * kNanosecondsPerSecond;
constexpr double kIntervalMemory = 0.3;  // [s]: long against slips of stamps
constexpr double kRepeatLasts = 3;       // [s] that the error of a stuck accelerometer stays

}  // namespace

void UsualInterval::add(double dt) {
  memory = std::min(memory + dt, kIntervalMemory);
  length += std::min(1.0, dt / memory) * (dt - length);
}

Admitted Intake::admit(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    return admit_increment(*increment);
  }
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) return admit_fix(*fix);
  if (const auto* pose = std::get_if<ReferencePose>(&measurement)) examination_.admit(*pose);
  return {measurement, {}, {}};
}

Admitted Intake::admit_increment(const ImuIncrement& increment) {
  const diagnosis::ImuGuard::Verdict verdict = examination_.admit(increment);
  if (!verdict.increment) return {{}, {}, verdict.notice};
  ++increments_;
  usual_interval_.add(verdict.increment->dt());
  ImuIncrement usable = *verdict.increment;
  if (verdict.accel_repeats) {
    usable.extra_accel_noise_density = options_.gaps.accel_sigma_m_s2 * std::sqrt(kRepeatLasts);
  }
  examination_.throw_if_useless();
  return {usable, {}, verdict.notice, verdict.accel_repeats};
}

Admitted Intake::admit_fix(GnssFix fix) {
  options_.aids.apply_to(fix);
  if (!first_fix_ns_) first_fix_ns_ = fix.t_ns;
  fix.since_first_s = seconds_between(*first_fix_ns_, fix.t_ns);
  const FixClass fix_class = classify(fix);
  count(fix_class, fix);
  switch (fix_class) {
    case FixClass::elsewhen:
      return {};
    case FixClass::repeated:
    case FixClass::held:
      return {{}, state::FixVerdict::out_of_order, {}};
    case FixClass::bad_position:
      return {{}, state::FixVerdict::bad_sigma, {}};
    case FixClass::bad_sigma:
    case FixClass::low_quality:
    case FixClass::usable:
      break;
  }
  return {fix, {}, {}};
}

/// What is not to be used of a fix that is good otherwise is taken off it.
Intake::FixClass Intake::classify(GnssFix& fix) {
  if (is_elsewhen(fix) || is_repeated(fix)) {
    examination_.count(fix);
    return is_elsewhen(fix) ? FixClass::elsewhen : FixClass::repeated;
  }
  last_fix_ = fix;
  const diagnosis::FixGuard::Verdict verdict = examination_.admit(fix);
  if (verdict.held) return FixClass::held;
  if (!verdict.fix) return FixClass::bad_position;
  fix = *verdict.fix;
  if (!options_.gnss.has_valid_sigma(fix)) return FixClass::bad_sigma;
  if (fix.quality < options_.gnss.lowest_quality()) return FixClass::low_quality;
  return FixClass::usable;
}

bool Intake::is_elsewhen(const GnssFix& fix) const {
  const std::optional<int64_t> imu_ns = examination_.imu_guard().last_end_ns();
  return imu_ns && std::abs(fix.t_ns - *imu_ns) > kElsewhenNs;
}

bool Intake::is_repeated(const GnssFix& fix) const {
  if (!last_fix_ || last_fix_->t_ns != fix.t_ns) return false;
  const Geodetic &a = fix.antenna, &b = last_fix_->antenna;
  return a.latitude == b.latitude && a.longitude == b.longitude && a.height == b.height;
}

void Intake::count(FixClass fix_class, const GnssFix& fix) {
  Tally& tally = fixes_[fix_class];
  if (tally.count++ == 0) tally.first_ns = fix.t_ns;
  if (fix_class == FixClass::elsewhen && !first_elsewhen_s_) {
    first_elsewhen_s_ = seconds_between(*examination_.imu_guard().last_end_ns(), fix.t_ns);
  }
}

int64_t Intake::count_of(FixClass fix_class) const {
  const auto found = fixes_.find(fix_class);
  return found == fixes_.end() ? 0 : found->second.count;
}

std::vector<std::string> Intake::summary(int64_t late) const {
  std::vector<std::string> lines = examination_.imu_guard().summary();
  for (const std::string& line : examination_.fix_guard().summary()) lines.push_back(line);
  if (const int64_t repeated = count_of(FixClass::repeated); repeated > 0) {
    lines.push_back(fmt::format("{} fixes repeat the one before them and were left out", repeated));
  }
  if (late > 0) {
    lines.push_back(fmt::format(
        "{} fixes came after later ones and were left out; sort the log by time", late));
  }
  if (const int64_t elsewhen = count_of(FixClass::elsewhen); elsewhen > 0) {
    lines.push_back(fmt::format("{} fixes were left out, the first stamped {}", elsewhen,
                                describe_mismatch(*first_elsewhen_s_)));
  }
  return lines;
}

void Intake::throw_if_nothing_usable() const {
  const diagnosis::ImuGuard& guard = examination_.imu_guard();
  if (2 * guard.left_out() > guard.seen()) {
    std::string why;
    for (const std::string& line : guard.summary()) why += (why.empty() ? "" : "; ") + line;
    throw DataError(fmt::format("{}; sort the IMU data by time and remove what is damaged", why));
  }
  if (increments_ == 0) {
    throw DataError(
        "no IMU data in the log; import a recording with angular rates and specific force");
  }
  int64_t fixes = 0;
  for (const auto& [fix_class, tally] : fixes_) fixes += tally.count;
  if (fixes == 0) {
    throw DataError("no GNSS fix in the log; import a recording with positions");
  }
  if (count_of(FixClass::usable) > 0) return;
  if (2 * count_of(FixClass::elsewhen) > fixes) {
    throw DataError(fmt::format("GNSS and IMU do not overlap in time: the fixes are stamped {}",
                                describe_mismatch(*first_elsewhen_s_)));
  }
  throw DataError(
      fmt::format("none of the {} GNSS fixes can be used: {}; give sigmas in the "
                  "import, or gnss.sigma_floor_m where they are zero",
                  fixes, unusable_fixes()));
}

/// How many of each kind, with the first: "4 with a sigma that ..., the first at ...".
std::string Intake::unusable_fixes() const {
  const std::pair<FixClass, std::string> kinds[] = {
      {FixClass::bad_sigma, "with a sigma that is zero, negative or not finite"},
      {FixClass::bad_position, "with no position (zero, not finite, out of range or reach)"},
      {FixClass::low_quality, "below gnss.min_quality=" + options_.gnss.min_quality},
      {FixClass::repeated, "that repeat the one before them"},
      {FixClass::held, "that repeat the position before them under a new stamp"},
      {FixClass::elsewhen, "stamped far from the IMU"}};
  std::string list;
  for (const auto& [fix_class, what] : kinds) {
    const auto found = fixes_.find(fix_class);
    if (found == fixes_.end()) continue;
    list += fmt::format("{}{} {}, the first at {}", list.empty() ? "" : "; ", found->second.count,
                        what, utc_text(found->second.first_ns));
  }
  return list;
}

}  // namespace foucault::navigation
