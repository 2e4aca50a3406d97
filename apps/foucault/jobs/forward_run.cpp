#include "jobs/forward_run.h"

#include <utility>

#include "foucault/core/profile.h"

namespace foucault::app {

ForwardRun::ForwardRun(const state::Mounting& mounting,
                       evaluation::SeparationCollector::Callback on_separation)
    : mounting_(mounting),
      comparison_(mounting,
                  [this](const state::Epoch& epoch, const state::ReferenceError& error) {
                    if (metrics_) metrics_->reference_error(epoch, error);
                  }),
      separation_(mounting, std::move(on_separation)) {}

void ForwardRun::start(int64_t from_ns) {
  metrics_.emplace(mounting_, from_ns);
  separation_.statistics_from(from_ns);
}

void ForwardRun::epoch(const state::Epoch& epoch) {
  const StageTimer timer(Stage::statistics);
  ran_ = true;
  if (metrics_) metrics_->epoch(epoch);
  comparison_.add(epoch);
  separation_.forward(epoch);
}

void ForwardRun::fix(const state::FixResult& fix) {
  if (ran_ && metrics_) metrics_->fix(fix);
}

std::optional<ForwardResult> ForwardRun::result(const std::string& method) const {
  if (!ran_ || !metrics_) return std::nullopt;
  return ForwardResult{method, metrics_->metrics(), separation_.metrics()};
}

}  // namespace foucault::app
