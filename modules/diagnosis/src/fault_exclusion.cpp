#include "foucault/diagnosis/fault_exclusion.h"

#include <fmt/format.h>

#include "foucault/core/time.h"
#include "foucault/state/blocks.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;

/// Chosen: wrong ambiguities and reflections last for seconds; a true jump is believed after 31 s.
constexpr double kOffsetStays = 30;  // [s]

}  // namespace

Eigen::Vector3d velocity_variance(const state::Epoch& epoch) {
  return state::part(epoch.covariance.diagonal(), state::block::velocity);
}

Lookahead::Lookahead(const measurement::Navigator& navigator)
    : start_(navigator.ahead(1)), ahead_(navigator.ahead(1)) {}

void Lookahead::propagate(const ImuIncrement& increment) {
  ahead_->propagate(increment);
  driven_.push_back(increment);
}

InnovationSample FaultExclusion::sample(const MetFix& met) const {
  return {met.fix.t_ns, met.innovation_n, judge_.level() * met.fix.position_covariance.diagonal(),
          met.square};
}

double FaultExclusion::lasted() const { return seconds_between(begin_.state.t_ns, last_fix_ns_); }

bool FaultExclusion::stays() const { return lasted() > kOffsetStays; }

void FaultExclusion::leave_out(const GnssFix& fix) {
  last_fix_ns_ = fix.t_ns;
  outcome_.fixes.push_back({Action::leave_out, fix, {}});
}

void FaultExclusion::use(const GnssFix& fix) {
  last_fix_ns_ = fix.t_ns;
  outcome_.fixes.push_back({Action::use, fix, {}});
  decided_ = true;
}

void FaultExclusion::believe_all() {
  for (FixDecision& decision : outcome_.fixes) decision.action = Action::use;
  decided_ = true;
}

/// The state's position was wrong, not its motion.
void FaultExclusion::believe_offset(double metres) {
  notice(fmt::format("fixes off by {:.2f} m since {} have stayed so and are believed", metres,
                     since()));
  outcome_.state_was_wrong = true;
  believe_all();
}

void FaultExclusion::notice_contradiction(const char* verdict) {
  notice(fmt::format("fixes since {} contradict the IMU, the first by {:.2f} m; {}", since(),
                     begin_.innovation_n.norm(), verdict));
}

}  // namespace foucault::diagnosis
