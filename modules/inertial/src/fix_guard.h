#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"

namespace foucault {

/// Looks at fixes before they are used, as ImuGuard does at increments. Left out, counted and named
/// are those that cannot be a position of this recording:
/// - no position at all, see is_position();
/// - out of reach: further from the last good one than kFarAway and what the fastest vehicle drives
///   in between. Where one place contradicts another the one that more fixes in a row give is
///   believed, at the latest after kLongestDoubt; so a wrong first fix costs one good one.
/// A velocity that is no number, or has no sigma, is taken off a good position.
class FixGuard {
 public:
  /// What may be used; none if the fix is left out.
  std::optional<GnssFix> look_at(const GnssFix& fix);

  /// One line a kind: how many were left out, and the first.
  std::vector<std::string> summary() const;

 private:
  struct Tally {
    int64_t count = 0;
    int64_t first_ns = 0;
    void add(int64_t t_ns);
  };
  /// Fixes in a row that a vehicle reaches from one another.
  struct Place {
    GnssFix last;
    int64_t since_ns = 0;
    int64_t fixes = 0;
  };

  bool in_reach(const GnssFix& fix);
  static void go_on(std::optional<Place>& place, const GnssFix& fix);

  std::optional<Place> believed_, doubted_;
  Tally no_position_, out_of_reach_, bad_velocity_;
};

}  // namespace foucault
