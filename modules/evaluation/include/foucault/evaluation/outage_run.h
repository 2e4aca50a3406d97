#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "foucault/evaluation/drift.h"
#include "foucault/evaluation/outage.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/layout.h"

namespace foucault::evaluation {

/// What drifts are measured against.
enum class DriftTruth { reference, withheld_fixes };

struct OutageRunResult {
  DriftTruth truth = DriftTruth::withheld_fixes;
  std::vector<OutageDrift> drifts;  ///< complete outages only
  std::vector<Outage> withheld;     ///< all in which a fix was withheld, in order
  /// How many of these end before the last fix. The estimator gave nothing to measure in those that
  /// are not in `drifts`.
  int64_t scheduled = 0;
  int64_t first_fix_ns = 0;
  int64_t last_fix_ns = 0;
  double cpu_s = 0;  ///< of this thread, reading included
};

struct OutageRunOptions {
  std::vector<double> marks_s = default_drift_marks_s();
  /// For an estimator that gives out at the end (a smoother), keep_s must span the recording.
  ReferenceComparisonOptions reference;
  state::Layout layout;  ///< of the epochs
};

/// Makes an estimator that gives out to the sink.
using EstimatorFactory =
    std::function<std::unique_ptr<state::Estimator>(const state::Mounting&, state::Sink&)>;

/// What else wants to see a run.
class OutageRunObserver : public state::Sink {
 public:
  virtual void reference_error(const state::Epoch&, const state::ReferenceError&) {}
  /// In outages: against the withheld fix of the same stamp, at the antenna, NED [m].
  virtual void withheld_error(const Outage&, const state::Epoch&, const Eigen::Vector3d&) {}
  virtual void progress(double) {}
};

/// Runs one estimator over one recording with outages. Truth is the reference if it covers
/// every outage that the withheld fixes cover, else these fixes, at the antenna.
/// Throws what source and estimator throw.
OutageRunResult run_with_outages(std::unique_ptr<state::Source> source,
                                 const OutageSchedule& schedule,
                                 const EstimatorFactory& make_estimator,
                                 const OutageRunOptions& options = {},
                                 OutageRunObserver* observer = nullptr);

}  // namespace foucault::evaluation
