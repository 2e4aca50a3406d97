#include "fix_gate.h"

#include "foucault/core/time.h"

namespace foucault::navigation {

using diagnosis::FixDecision;

void FixGate::start(int64_t t_ns) {
  judge_.start(t_ns);
  last_used_ns_ = t_ns;
}

void FixGate::learn(const diagnosis::DoubtOutcome& outcome) {
  decided_.clear();
  for (const FixDecision& decision : outcome.fixes) decided_.emplace(decision.fix.t_ns, decision);
  for (const double square : outcome.level) judge_.remember(square);
}

std::optional<FixDecision> FixGate::decide(const GnssFix& fix, const state::Innovation& innovation,
                                           double usual_interval) {
  if (std::optional<FixDecision> decision = decided_before(fix)) return decision;
  const bool believed = judge_.believes(fix.t_ns, innovation);
  if (!believed || returns_after_outage(fix, usual_interval)) return std::nullopt;
  return FixDecision{FixDecision::Action::use, fix, {}};
}

std::optional<FixDecision> FixGate::decided_before(const GnssFix& fix) {
  const auto found = decided_.find(fix.t_ns);
  if (found == decided_.end()) return std::nullopt;
  const FixDecision decision = found->second;
  decided_.erase(found);
  return decision;
}

bool FixGate::is_unheld(const GnssFix& fix) const {
  constexpr double kUnheld = 2.5;  // [s]
  return seconds_between(last_used_ns_, fix.t_ns) > kUnheld && !judge_.gate_is_open(fix.t_ns);
}

/// Unheld for longer than usual in this recording.
bool FixGate::returns_after_outage(const GnssFix& fix, double usual_interval) const {
  constexpr double kOutageIntervals = 3.5;  // of fixes
  return is_unheld(fix) &&
         seconds_between(last_used_ns_, fix.t_ns) > kOutageIntervals * usual_interval;
}

}  // namespace foucault::navigation
