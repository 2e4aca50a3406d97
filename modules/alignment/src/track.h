#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "foucault/core/measurement.h"

namespace foucault::alignment {

/// What the alignment drives over: an increment, or a fix at the end of the one before.
using Step = std::variant<ImuIncrement, GnssFix>;

/// The recording as the alignment needs it: increments of 20 ms without holes, cut at the fixes,
/// and at most five fixes a second, whose errors hardly differ within less. Bounded: what is older
/// than `longest_s` goes.
class Track {
 public:
  explicit Track(double longest_s);

  /// It is given out once the increments have reached it.
  void add(const GnssFix& fix);
  /// Steps that are complete now; they are kept as well. Precondition: after the last one.
  std::vector<Step> add(const ImuIncrement& increment);

  const std::deque<Step>& steps() const { return steps_; }
  /// Kept fixes from the first one on that are at least `shortest_s` and three together; fewer if
  /// there are no more.
  std::vector<GnssFix> first_fixes(double shortest_s, int64_t from_ns = INT64_MIN) const;
  /// Forgets what is not later than `t_ns`.
  void forget_until(int64_t t_ns);

  /// Mean specific force over the increments that are kept; zero without.
  Eigen::Vector3d mean_force_b() const;
  /// Of the first increment that is kept, or the end of the last.
  int64_t begin_ns() const;

 private:
  void append(const ImuIncrement& increment, std::vector<Step>& complete);
  void close_piece(std::vector<Step>& complete);
  void keep(const Step& step, std::vector<Step>& complete);

  int64_t longest_ns_;
  std::deque<Step> steps_;
  ImuIncrement piece_;  ///< growing
  std::optional<int64_t> end_ns_;
  std::deque<GnssFix> waiting_;
  std::optional<int64_t> last_fix_ns_;
};

}  // namespace foucault::alignment
