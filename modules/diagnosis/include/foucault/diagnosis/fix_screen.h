#pragma once

#include <deque>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// Tells, before there is a state to predict fixes from, which of them no vehicle reaches from
/// their neighbours: those off a straight line between them by more than kAcceleration explains.
/// Holds measurements back until the next fix, at most kLongestWait. The first fix passes; if it is
/// an outlier, good ones go with it until five in a row agree with each other.
class FixScreen {
 public:
  struct Screened {
    Measurement measurement;
    bool plausible = true;
  };

  void add(const Measurement& measurement) { waiting_.push_back(measurement); }

  /// The next one on which there is nothing more to wait for; with `all`, the next one.
  std::optional<Screened> next(bool all = false);

  /// What still waits, in order; it is empty afterwards.
  std::deque<Measurement> take_all();

  void restart();

 private:
  bool doubted_agree(const GnssFix& fix, const GnssFix& after);
  void believe(const GnssFix& fix);
  std::optional<GnssFix> second_fix() const;

  std::deque<Measurement> waiting_;
  std::optional<GnssFix> before_;   ///< the last plausible one
  std::optional<GnssFix> doubted_;  ///< the last since then, if there is one
  int agreeing_ = 0;                ///< in a row, of these
};

}  // namespace foucault::diagnosis
