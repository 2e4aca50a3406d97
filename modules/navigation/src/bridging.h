#pragma once

#include <deque>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/navigation/gap_options.h"
#include "imu_hole.h"

namespace foucault::navigation {

/// The phase in a hole between increments that may hide a turn: what follows is held back until the
/// course after the hole tells how the vehicle has turned in it, three seconds at most.
class Bridging {
 public:
  /// The hole ends with hole.after, which is held back as the first.
  explicit Bridging(const ImuHole& hole) : hole_(hole), held_{hole.after} {}

  /// Holds it back. True once the turn is known, or will not be.
  bool take(const Measurement& measurement);

  const ImuHole& hole() const { return hole_; }
  /// What fills the hole, from its beginning to its end.
  std::vector<ImuIncrement> bridge(const GapOptions& options) const;
  /// What was held back, in order.
  const std::deque<Measurement>& held() const { return held_; }

 private:
  int64_t held_end_ns() const;

  ImuHole hole_;
  std::deque<Measurement> held_;
};

}  // namespace foucault::navigation
