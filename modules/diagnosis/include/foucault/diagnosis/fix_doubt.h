#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fault_exclusion.h"
#include "foucault/diagnosis/gnss_options.h"

namespace foucault::diagnosis {

/// A fix that does not agree with the prediction, or the first one after an outage, raises a doubt:
/// what follows is held back while a copy of the navigator drives ahead on it, until it shows
/// whether the fixes were wrong or the state. So what is true is used from its beginning on, in
/// every method, whenever it was understood. What decides is Reacquisition after an outage,
/// InnovationMonitor otherwise; after 90 s it must.
class FixDoubt {
 public:
  /// At the current time of `navigator`, which stands before the use of `fix`. `returns`: no fix
  /// has held the state for a while.
  FixDoubt(const GnssOptions& options, const FixJudge& judge,
           const measurement::Navigator& navigator, const GnssFix& fix, bool returns);

  /// In the order in which the navigator will get them; fixes that can be judged only. True once it
  /// is decided, also by what ends the sight ahead: a hole, or no fixes any more.
  bool add(const Measurement& measurement);

  /// As far as it is known.
  DoubtOutcome outcome();

 private:
  void add_increment(const ImuIncrement& increment);
  ImuIncrement drive_to(int64_t t_ns, const ImuIncrement& increment);
  void propagate(const ImuIncrement& increment);
  void meet(const GnssFix& fix);

  Lookahead ahead_;
  std::unique_ptr<FaultExclusion> exclusion_;
  int64_t begin_ns_, time_ns_, last_fix_ns_;
  std::multimap<int64_t, GnssFix> waiting_;  ///< stamped ahead of the increments
};

}  // namespace foucault::diagnosis
