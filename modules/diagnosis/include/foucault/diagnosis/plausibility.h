#pragma once

#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/force_facts.h"
#include "foucault/diagnosis/force_match.h"
#include "foucault/diagnosis/turn_match.h"

namespace foucault::diagnosis {

/// Looks for what makes a recording useless whatever the method: specific force or angular rates
/// in other units or of a wrong scale, turned axes, clocks that are seconds apart.
class Plausibility {
 public:
  Plausibility();

  /// What was admitted, and of fixes what may be used.
  void watch(const ImuIncrement& increment);
  void watch(const GnssFix& fix);

  /// After an increment: throws DataError that names it and the remedy, as soon as it is certain.
  void throw_if_useless();

  ForceFacts force() const;
  std::optional<TurnMatch> turns() const { return turn_matcher_.best(); }

 private:
  bool force_is_due();
  void look_at_force();
  void look_at_turns();

  int64_t now_ns_ = 0;
  MeanForce mean_force_;
  ForceMatch force_match_;
  TurnMatcher turn_matcher_;
  double next_force_look_s_;
  int64_t next_window_look_;
  int64_t next_turn_look_;
};

}  // namespace foucault::diagnosis
