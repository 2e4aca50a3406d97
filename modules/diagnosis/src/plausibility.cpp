#include "foucault/diagnosis/plausibility.h"

#include <fmt/format.h>

#include <limits>

#include "foucault/core/error.h"

namespace foucault::diagnosis {
namespace {

/// Clocks of one recording that are further apart have no more in common than the date.
constexpr double kLongestOffset = 25;  // [s]
constexpr double kStep = 0.25;         // [s]
/// The mean of the specific force is looked at twice: when bumps have averaged out, and when it
/// must be gravity, see force_facts.cpp.
constexpr double kFirstForceLook = 10;   // [s]
constexpr double kSecondForceLook = 60;  // [s]
// Chosen: a look goes over all windows or offsets, and little is new to the next.
constexpr int64_t kWindowsBetweenLooks = 10;
constexpr int64_t kSamplesBetweenLooks = 20;
/// Chosen: a whole turn in all, in twice the courses that a TurnMatch needs.
constexpr int64_t kSamplesNeeded = 40;
constexpr double kTurnNeeded = 6.3;  // [rad]

}  // namespace

Plausibility::Plausibility()
    : turn_matcher_(kLongestOffset, kStep),
      next_force_look_s_(kFirstForceLook),
      next_window_look_(kWindowsBetweenLooks),
      next_turn_look_(kSamplesBetweenLooks) {}

void Plausibility::watch(const ImuIncrement& increment) {
  now_ns_ = increment.t_end_ns;
  mean_force_.add(increment);
  turn_matcher_.add(increment);
  force_match_.add(increment);
}

void Plausibility::watch(const GnssFix& fix) {
  turn_matcher_.add(fix);
  force_match_.add(fix);
}

ForceFacts Plausibility::force() const {
  ForceFacts facts = mean_force_.facts();
  facts.factor = force_match_.factor();
  return facts;
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
  if (turn_matcher_.samples() < next_turn_look_) return;
  next_turn_look_ = turn_matcher_.samples() + kSamplesBetweenLooks;
  const std::optional<TurnMatch> match = turn_matcher_.best();
  if (!match) return;
  const bool clocks_show = match->samples >= kSamplesNeeded && match->turned >= kTurnNeeded;
  const std::optional<std::string> wrong =
      clocks_show ? gross_mismatch(*match, now_ns_) : wrong_rates(*match);
  if (wrong) throw DataError(*wrong);
}

}  // namespace foucault::diagnosis
