#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/tally.h"

namespace foucault::diagnosis {

/// Tells where one position is given again and again under new stamps, as tables at the rate of the
/// IMU do, or drivers that publish faster than the receiver measures: of the last ten positions,
/// eight came twice or more, and did so while the vehicle moved on, or three times or more and
/// equally often. A receiver in motion never gives the same latitude and longitude twice, and one
/// at rest gives them once, twice, five times, as noise will have it.
class HeldPositions {
 public:
  /// Whether this fix repeats the one before it in such a recording.
  bool repeats(const GnssFix& fix);

 private:
  /// Fixes of one position.
  struct Run {
    int fixes = 0;
    bool moving = false;
  };
  void end_run(const GnssFix& next);
  bool is_held() const;

  std::optional<GnssFix> first_;  ///< of the present run
  int64_t last_ns_ = 0;
  int fixes_ = 0;
  std::deque<Run> runs_;
};

/// Looks at fixes before they are used, as ImuGuard does at increments. Left out, counted and named
/// are those that cannot be a position of this recording:
/// - no position at all, see is_position();
/// - held: the position of the fix before, in a recording that repeats positions;
/// - out of reach of the last good one, see geodesy::within_reach(). Where one place contradicts
/// another the one that more fixes in a row give is
///   believed, at the latest after a minute; so a wrong first fix costs one good one.
/// A velocity that is no number, or has no sigma, is taken off a good position.
class FixGuard {
 public:
  struct Verdict {
    std::optional<GnssFix> fix;  ///< what may be used; none if the fix is left out
    bool held = false;           ///< for this reason
  };
  Verdict look_at(const GnssFix& fix);

  /// One line a kind: how many were left out, and the first.
  std::vector<std::string> summary() const;

 private:
  /// Fixes in a row that a vehicle reaches from one another.
  struct Place {
    GnssFix last;
    int64_t since_ns = 0;
    int64_t fixes = 0;
  };

  bool in_reach(const GnssFix& fix);
  static void go_on(std::optional<Place>& place, const GnssFix& fix);

  std::optional<Place> believed_, doubted_;
  HeldPositions held_positions_;
  int64_t seen_ = 0;
  Tally no_position_, out_of_reach_, held_, bad_velocity_;
};

}  // namespace foucault::diagnosis
