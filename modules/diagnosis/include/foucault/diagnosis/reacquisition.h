#pragma once

#include <optional>
#include <vector>

#include "foucault/diagnosis/fault_exclusion.h"
#include "foucault/diagnosis/return_trial.h"

namespace foucault::diagnosis {

/// Fault exclusion when fixes come again after an outage, in which the state has drifted by an
/// unknown amount. ReturnTrial decides by the first of them. Fixes that are in error by it are left
/// out until they jump; then those before or those after the jump are true, whichever agree with
/// the prediction better. An offset that stays is the truth.
class Reacquisition : public FaultExclusion {
 public:
  /// `navigator` stands before the use of `first`. `ahead` lives as long as this.
  Reacquisition(const FixJudge& judge, DoubtBegin begin, const measurement::Navigator& navigator,
                const GnssFix& first, const Lookahead& ahead);

  void propagate(const ImuIncrement& increment) override { trial_.propagate(increment); }
  void meet(const MetFix& met) override;
  void give_up(const GnssFix& last) override;
  void settle() override;

 private:
  void judge_trial();
  void begin_offset();
  void follow_offset(const MetFix& met);
  void end_offset(bool later_are_true, int64_t now_ns);

  const Lookahead& ahead_;
  ReturnTrial trial_;
  std::vector<MetFix> met_;         ///< until the trial is over
  std::vector<std::size_t> tried_;  ///< which of the fixes the trial has got
  bool offset_is_certain_ = false;
  std::optional<InnovationLine> line_;  ///< the offset
  int missed_ = 0;                      ///< fixes in a row that do not have it
  int64_t first_missed_ns_ = 0;         ///< the first of them
};

}  // namespace foucault::diagnosis
