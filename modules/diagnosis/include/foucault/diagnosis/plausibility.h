#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/acceleration_match.h"
#include "foucault/diagnosis/force_facts.h"
#include "foucault/diagnosis/force_match.h"
#include "foucault/diagnosis/turn_match.h"

namespace foucault::diagnosis {

/// Looks for what makes a recording useless whatever the method: specific force or angular rates
/// in other units or of a wrong scale, turned axes, clocks that are seconds apart.
class Plausibility {
 public:
  explicit Plausibility(const Eigen::Quaterniond& q_v_b = Eigen::Quaterniond::Identity());

  /// What was admitted, and of fixes what may be used.
  void watch(const ImuIncrement& increment);
  void watch(const GnssFix& fix);

  /// After an increment: throws DataError that names it and the remedy, as soon as it is certain.
  void throw_if_useless();

  ForceFacts force() const;  ///< its mean in v
  /// An offset of more than a second is believed where turns along the course fit clearly better
  /// with it.
  std::optional<TurnMatch> turns() const;
  std::optional<AccelerationFit> accelerations() const { return acceleration_match_.best(); }

 private:
  bool force_is_due();
  void look_at_force();
  void look_at_turns();

  Eigen::Quaterniond q_v_b_;
  int64_t now_ns_ = 0;
  MeanForce mean_force_;
  ForceMatch force_match_;
  AccelerationMatch acceleration_match_;
  TurnMatcher near_, far_;
  double next_force_look_s_;
  int64_t next_window_look_;
  int64_t next_turn_look_;
};

}  // namespace foucault::diagnosis
