#include "foucault/diagnosis/plausibility.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/diagnosis/missing.h"
#include "foucault/diagnosis/side_facts.h"
#include "foucault/imu/increments.h"

namespace foucault::diagnosis {
namespace {

/// Clocks of one recording that are further apart have no more in common than the date.
constexpr double kLongestOffset = 25;  // [s]
constexpr double kStep = 0.25;         // [s]
constexpr double kNear = 1;            // [s], beyond which clocks are not just late
constexpr double kFineStep = 0.02;     // [s]
/// Ratio of what turns do not explain. By chance 40 courses leave a quarter once in a million
/// times.
constexpr double kClearly = 0.25;
constexpr double kTurnsAgree = 0.9;  // as in turn_match.cpp
/// The mean of the specific force is looked at twice: when bumps have averaged out, and when it
/// must be gravity, see force_facts.cpp.
constexpr double kFirstForceLook = 10;   // [s]
constexpr double kSecondForceLook = 60;  // [s]
// Chosen: a look goes over all windows or offsets, and little is new to the next.
constexpr int64_t kWindowsBetweenLooks = 10;
constexpr int64_t kSamplesBetweenLooks = 20;
constexpr int64_t kLong = 80;       // courses, twice as many as are enough
constexpr double kLongTurn = 12.6;  // [rad], two whole turns

}  // namespace

Plausibility::Plausibility(const Eigen::Quaterniond& q_v_b)
    : q_v_b_(q_v_b),
      acceleration_match_(q_v_b),
      near_(kNear, kFineStep, q_v_b),
      far_(kLongestOffset, kStep, q_v_b),
      next_force_look_s_(kFirstForceLook),
      next_window_look_(kWindowsBetweenLooks),
      next_turn_look_(kSamplesBetweenLooks) {}

/// Over a few samples that are missing the motion goes on: the matchers add it up.
void Plausibility::watch(const ImuIncrement& given) {
  const double gap = now_ns_ > 0 ? seconds_between(now_ns_, given.t_begin_ns) : 0;
  const ImuIncrement increment =
      gap > 0 && gap <= kLongestMissing ? imu::begun_at(given, now_ns_) : given;
  now_ns_ = increment.t_end_ns;
  mean_force_.add(increment);
  acceleration_match_.add(increment);
  near_.add(increment);
  far_.add(increment);
  force_match_.add(increment);
}

void Plausibility::watch(const GnssFix& fix) {
  acceleration_match_.add(fix);
  near_.add(fix);
  far_.add(fix);
  force_match_.add(fix);
}

ForceFacts Plausibility::force() const {
  ForceFacts facts = mean_force_.facts();
  facts.mean = q_v_b_ * facts.mean;
  facts.factor = force_match_.factor();
  return facts;
}

std::optional<TurnMatch> Plausibility::turns() const {
  std::optional<TurnMatch> near = near_.best();
  const std::optional<TurnMatch> far = near ? far_.best() : std::nullopt;
  if (!far || far->correlation < kTurnsAgree || std::abs(far->offset_s) < kNear) return near;
  const auto unexplained = [](const TurnMatch& match) {
    return 1 - match.correlation * match.correlation;
  };
  return unexplained(*far) < kClearly * unexplained(*near) ? far : near;
}

void Plausibility::throw_if_useless() {
  look_at_force();
  look_at_turns();
}

bool Plausibility::force_is_due() {
  bool due = false;
  if (mean_force_.seconds() > next_force_look_s_) {
    const bool was_first = next_force_look_s_ < kSecondForceLook;
    next_force_look_s_ = was_first ? kSecondForceLook : std::numeric_limits<double>::infinity();
    due = true;
  }
  if (force_match_.windows() >= next_window_look_) {
    next_window_look_ = force_match_.windows() + kWindowsBetweenLooks;
    due = true;
  }
  return due;
}

void Plausibility::look_at_force() {
  if (!force_is_due()) return;
  if (const std::optional<WrongForce> wrong = wrong_force(force())) {
    throw DataError(fmt::format("{}; {}", wrong->text, wrong->remedy));
  }
}

void Plausibility::look_at_turns() {
  if (far_.samples() < next_turn_look_) return;
  next_turn_look_ = far_.samples() + kSamplesBetweenLooks;
  const std::optional<TurnMatch> match = turns();
  if (!match) return;
  if (const std::optional<std::string> wrong = gross_mismatch(*match, now_ns_)) {
    throw DataError(*wrong);
  }
  const std::optional<AccelerationFit> forces = accelerations();
  const bool forces_tell = forces && forces->is_side_known;
  // Outliers turn courses as well, for a while.
  const bool is_long = match->samples >= kLong && match->turned >= kLongTurn;
  if (!match->is_enough() || match->correlation > -kTurnsAgree || !(forces_tell || is_long)) return;
  if (const std::optional<WrongForce> side = wrong_side(*match, forces, force().mean)) {
    throw DataError(fmt::format("{}; {}", side->text, side->remedy));
  }
}

}  // namespace foucault::diagnosis
