#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_doubt.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/diagnosis/gnss_options.h"

namespace foucault::navigation {

/// Says what a fix is, once its innovation is known: one to use, one about which a doubt has
/// decided before, or one to doubt.
class FixGate {
 public:
  explicit FixGate(const diagnosis::GnssOptions& options) : judge_(options) {}

  /// A run starts.
  void start(int64_t t_ns);
  void used(int64_t t_ns) { last_used_ns_ = t_ns; }
  /// The state has become worse than its covariance may say.
  void doubt_state(int64_t t_ns) { judge_.doubt_state(t_ns); }
  void learn(const diagnosis::DoubtOutcome& outcome);

  /// None: it is in doubt. `usual_interval`: between used fixes [s].
  std::optional<diagnosis::FixDecision> decide(const GnssFix& fix,
                                               const state::Innovation& innovation,
                                               double usual_interval);
  /// So long without fixes is more than one or two that were left out, and long enough for a drift.
  bool is_unheld(const GnssFix& fix) const;

  const diagnosis::FixJudge& judge() const { return judge_; }

 private:
  std::optional<diagnosis::FixDecision> decided_before(const GnssFix& fix);
  bool returns_after_outage(const GnssFix& fix, double usual_interval) const;

  diagnosis::FixJudge judge_;
  std::multimap<int64_t, diagnosis::FixDecision> decided_;  ///< of fixes to come, by stamp
  int64_t last_used_ns_ = 0;                                ///< fix, or start
};

}  // namespace foucault::navigation
