#pragma once

#include <optional>
#include <string>

#include "foucault/diagnosis/force_match.h"
#include "foucault/core/measurement.h"
#include "foucault/diagnosis/turn_match.h"

namespace foucault::diagnosis {

/// What is wrong with a specific force whose mean has this length [m/s^2]; none if it may be
/// gravity, as the mean of any vehicle's is.
std::optional<std::string> wrong_force(double mean);

/// Looks for what makes a recording useless whatever the method: specific force or angular rates
/// in other units or of a wrong scale, turned axes, clocks that are seconds apart.
class Plausibility {
 public:
  /// Throw DataError that names it and the remedy, as soon as it is certain.
  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix) {
    matcher_.add(fix);
    force_match_.add(fix);
  }

 private:
  void look_at_force(const ImuIncrement& increment);
  void look_at_force_factor();
  void look_at_turns(int64_t t_ns);

  static constexpr double kLongestOffset = 25;  // [s]
  static constexpr double kStep = 0.25;         // [s]

  Eigen::Vector3d force_sum_b_ = Eigen::Vector3d::Zero();
  double force_time_ = 0;
  ForceMatch force_match_;
  int64_t windows_looked_at_ = 0;
  TurnMatcher matcher_{kLongestOffset, kStep};
  int64_t samples_looked_at_ = 0;
};

}  // namespace foucault::diagnosis
