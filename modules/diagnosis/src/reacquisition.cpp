#include "foucault/diagnosis/reacquisition.h"

#include <fmt/format.h>

#include "foucault/core/time.h"

namespace foucault::diagnosis {

using Action = FixDecision::Action;
using Eigen::Vector3d;

Reacquisition::Reacquisition(const FixJudge& judge, DoubtBegin begin,
                             const measurement::Navigator& navigator, const GnssFix& first,
                             const Lookahead& ahead)
    : FaultExclusion(judge, std::move(begin)),
      ahead_(ahead),
      trial_(navigator, first, judge.level()) {}

/// Fixes that come fast are thinned for the trial: their errors are those of their neighbours.
void Reacquisition::meet(const MetFix& met) {
  leave_out(met.fix);
  if (line_) return follow_offset(met);
  met_.push_back(met);
  const auto since_tried = [&] {
    return seconds_between(outcome_.fixes[tried_.back()].fix.t_ns, met.fix.t_ns);
  };
  if (!tried_.empty() && since_tried() < kThinning) return;
  tried_.push_back(outcome_.fixes.size() - 1);
  trial_.add(met.fix);
  if (trial_.is_over()) judge_trial();
}

void Reacquisition::judge_trial() {
  const ReturnTrial::Verdict verdict = trial_.verdict();
  offset_is_certain_ = verdict.certainly;
  if (verdict.offset) return begin_offset();
  for (FixDecision& decision : outcome_.fixes) decision.action = Action::use;
  for (std::size_t i = 0; i < tried_.size(); ++i) {
    if (!verdict.used[i]) outcome_.fixes[tried_[i]].action = Action::leave_out;
  }
  outcome_.state_was_wrong = verdict.scale > 1;
  decided_ = true;
}

/// The fixes are off in position alone. The IMU knows how they go on.
void Reacquisition::begin_offset() {
  notice(
      fmt::format("fixes since {}, the first after an outage, are off by {:.2f} m, but not their "
                  "motion; left out unless it stays",
                  since(), begin_.innovation_n.norm()));
  line_ = InnovationLine();
  line_->t_ns = begin_.state.t_ns;
  line_->offset_n = begin_.innovation_n;
  for (const MetFix& met : met_) {
    if (!decided_) follow_offset(met);
  }
}

/// An offset goes on as the state's velocity lets it; where it does not, the fixes have jumped, and
/// those before or those after are in error: which of them, the prediction tells that no fix of the
/// doubt has touched.
void Reacquisition::follow_offset(const MetFix& met) {
  const double dt = seconds_between(line_->t_ns, met.fix.t_ns);
  const Vector3d variance_n =
      2 * sample(met).variance_n + dt * dt * velocity_variance(ahead_.epoch());
  const Vector3d change_n = met.innovation_n - line_->offset_n;
  if (judge_.passes(mahalanobis_squared(change_n, variance_n.asDiagonal()))) {
    line_->t_ns = met.fix.t_ns;
    line_->offset_n = met.innovation_n;
    missed_ = 0;
    return;
  }
  if (missed_++ == 0) first_missed_ns_ = met.fix.t_ns;
  if (missed_ < kMissesThatEndLine) return;
  const bool after_is_nearer =
      met.square < mahalanobis_squared(line_->offset_n, met.innovation_covariance);
  end_offset(after_is_nearer, met.fix.t_ns);
}

void Reacquisition::end_offset(bool later_are_true, int64_t now_ns) {
  notice(fmt::format("fixes have jumped shortly before {}; those {} are believed", utc_text(now_ns),
                     later_are_true ? "after it" : "before it"));
  for (FixDecision& decision : outcome_.fixes) {
    const bool is_true = (decision.fix.t_ns >= first_missed_ns_) == later_are_true;
    decision.action = is_true ? Action::use : Action::leave_out;
  }
  outcome_.state_was_wrong = !later_are_true;
  decided_ = true;
}

/// Without an offset by now, fixes are too rare for a trial, and are believed: the state has come
/// where it is by a drift, for which its covariance is enough.
void Reacquisition::give_up(const GnssFix& last) {
  leave_out(last);
  if (line_) return believe_offset(line_->offset_n.norm());
  believe_all();
  outcome_.state_was_wrong = true;
  notice_contradiction("the state is taken for wrong there");
}

void Reacquisition::settle() {
  if (decided_) return;
  if (!line_) judge_trial();
  if (line_ && (stays() || !offset_is_certain_)) believe_offset(line_->offset_n.norm());
  decided_ = true;
}

}  // namespace foucault::diagnosis
