#include "bridging.h"

#include <algorithm>

#include "foucault/core/time.h"

namespace foucault::navigation {

bool Bridging::take(const Measurement& measurement) {
  constexpr double kLongestWait = 3;  // [s], for fixes after a hole
  const auto* increment = std::get_if<ImuIncrement>(&measurement);
  const bool next_hole = increment && increment->t_begin_ns > held_end_ns();
  held_.push_back(measurement);
  const double waited = seconds_between(hole_.after.t_begin_ns, stamp(measurement));
  if (std::holds_alternative<GnssFix>(measurement)) hole_.turn = turn_over(hole_, held_);
  return hole_.turn || next_hole || waited > kLongestWait;
}

/// Of the last increment.
int64_t Bridging::held_end_ns() const {
  for (auto m = held_.rbegin(); m != held_.rend(); ++m) {
    if (const auto* increment = std::get_if<ImuIncrement>(&*m)) return increment->t_end_ns;
  }
  return hole_.after.t_end_ns;
}

std::vector<ImuIncrement> Bridging::bridge(const GapOptions& options) const {
  const int64_t step_ns = hole_.step_ns();
  std::vector<ImuIncrement> made_up;
  for (int64_t begin_ns = hole_.before.t_ns; begin_ns < hole_.after.t_begin_ns;) {
    const int64_t end_ns = std::min(begin_ns + step_ns, hole_.after.t_begin_ns);
    made_up.push_back(made_up_increment(hole_, options, begin_ns, end_ns));
    begin_ns = end_ns;
  }
  return made_up;
}

}  // namespace foucault::navigation
