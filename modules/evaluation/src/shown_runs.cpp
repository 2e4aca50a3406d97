#include "foucault/evaluation/shown_runs.h"

namespace foucault::evaluation {

std::optional<std::size_t> ShownRuns::place(const RunName& run) {
  constexpr std::size_t kMostRecordings = 6;
  for (std::size_t i = 0; i < firsts_.size(); ++i) {
    const RunName& first = firsts_[i];
    if (first.imu != run.imu || (!by_imu_ && first.recording != run.recording)) continue;
    return first.is_compared_with(run) ? std::optional(i) : std::nullopt;
  }
  if (firsts_.size() == kMostRecordings) return std::nullopt;
  firsts_.push_back(run);
  return firsts_.size() - 1;
}

}  // namespace foucault::evaluation
