#include "foucault/diagnosis/stream_facts.h"

#include <algorithm>

#include "foucault/core/hole.h"
#include "foucault/core/time.h"

namespace foucault::diagnosis {

void StreamWatch::add(int64_t t_ns) {
  if (facts_.count++ == 0) {
    facts_.first_ns = facts_.last_ns = t_ns;
    return;
  }
  const double interval = seconds_between(facts_.last_ns, t_ns);
  if (interval <= 0) return;
  facts_.last_ns = t_ns;
  learn(interval);
  if (!is_hole(interval, facts_.interval_s)) return;
  ++facts_.holes;
  facts_.longest_hole_s = std::max(facts_.longest_hole_s, interval);
}

/// The median is taken anew with each of the first intervals, then with each fiftieth.
void StreamWatch::learn(double interval) {
  constexpr std::size_t kFew = 50;
  if (intervals_.full()) return;
  intervals_.add(interval);
  if (intervals_.size() < kFew || intervals_.size() % kFew == 0) {
    facts_.interval_s = intervals_.median();
  }
}

}  // namespace foucault::diagnosis
