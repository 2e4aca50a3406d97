#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "foucault/diagnosis/fault_exclusion.h"
#include "foucault/diagnosis/gnss_options.h"

namespace foucault::diagnosis {

/// Fault exclusion while the state was held by fixes a moment ago, so that the IMU tells to cm/s
/// how it moves, by the sequence of innovations:
/// - a fix that agrees again ends the doubt; those in between were wrong;
/// - fixes that scatter about the prediction have sigmas that are too small, and are believed;
/// - fixes on a line, an offset that is constant (a step fault) or grows steadily from nothing (a
///   ramp fault), are in error, and used without it. One that grows until the doubt is given up, or
///   is constant for so long, or still constant when no more fixes come after 30 s, is the truth;
/// - fixes that leave the prediction smoothly on any other way, or by a jump and then steadily, as
///   when they return from an error that the state has followed, are true: the state was wrong;
/// - those that scatter wildly are waited through.
/// Where the state is doubted itself (after the alignment and holes) a few fixes in a row suffice
/// to be believed.
class InnovationMonitor : public FaultExclusion {
 public:
  /// `ahead` lives as long as this.
  InnovationMonitor(const GnssOptions& options, const FixJudge& judge, DoubtBegin begin,
                    Lookahead& ahead);

  void meet(const MetFix& met) override;
  void give_up(const GnssFix& last) override;
  void settle() override;

 private:
  void remember(const MetFix& met);
  std::size_t look_needs() const;
  void look_at();
  void begin_line(const InnovationLine& line, bool drifts);
  void follow_line(const MetFix& met);
  void end_line(const GnssFix& fix);
  void use_corrected(const MetFix& met);
  void miss_line();
  void move_state();
  void blame_state();
  /// The doubt once more, by another navigator: which fixes are true to it.
  struct Pass {
    double log_probability = 0;
    std::vector<bool> is_true;
    bool believes_most() const;
  };
  Pass drive_again(std::unique_ptr<measurement::Navigator> navigator) const;
  Pass try_scales(Pass best);
  state::NodeMatrix looseness() const;
  InnovationLine fit() const;
  bool goes_on(const InnovationLine& line) const;

  int64_t reinstate_after_;
  Lookahead& ahead_;
  state::Epoch
      held_;  ///< at the beginning; without a covariance once a line has shown its velocity
  InnovationSamples recent_;
  int64_t from_ns_;                                   ///< where recent_ begins
  Eigen::Vector3d from_n_ = Eigen::Vector3d::Zero();  ///< what the last line came to there
  std::optional<InnovationLine> line_;
  bool line_drifts_ = false;
  int line_missed_ = 0;  ///< fixes in a row that do not lie on it
};

}  // namespace foucault::diagnosis
