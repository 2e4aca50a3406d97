#pragma once

#include <optional>
#include <string>

#include "foucault/evaluation/reference_error.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/evaluation/separation.h"
#include "foucault/state/interfaces.h"

namespace foucault::app {

/// What the forward run of a smoother was.
struct ForwardResult {
  std::string method;
  evaluation::RunMetrics metrics;  ///< innovations are those of the run itself
  evaluation::SeparationMetrics separation;
};

/// Judges the forward run of a smoother as a run of its own, and what smoothing made of it.
class ForwardRun {
 public:
  ForwardRun(const state::Mounting& mounting,
             evaluation::SeparationCollector::Callback on_separation);

  /// Statistics count from there on.
  void start(int64_t from_ns);
  void reference(const ReferencePose& reference) { comparison_.add(reference); }
  void epoch(const state::Epoch& epoch);
  /// Innovations of a smoother's fixes are those of its forward run.
  void fix(const state::FixResult& fix);
  void smoothed(const state::Epoch& epoch) { separation_.smoothed(epoch); }
  /// None if there was no forward run.
  std::optional<ForwardResult> result(const std::string& method) const;

 private:
  state::Mounting mounting_;
  std::optional<evaluation::RunMetricsCollector> metrics_;
  evaluation::ReferenceComparison comparison_;
  evaluation::SeparationCollector separation_;
  bool ran_ = false;
};

}  // namespace foucault::app
