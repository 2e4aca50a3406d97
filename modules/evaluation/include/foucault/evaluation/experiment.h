#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/evaluation/drift_table.h"
#include "foucault/evaluation/error_track.h"
#include "foucault/evaluation/executor.h"
#include "foucault/evaluation/outage_run.h"
#include "foucault/state/interfaces.h"

/// Many recordings x methods x shifted schedules, and what comes out of comparing them.
namespace foucault::evaluation {

/// Opens a recording from its beginning; called on the thread of the run.
using SourceFactory = std::function<std::unique_ptr<state::Source>()>;

/// What a source has to say of the recording once it has come to the end.
struct SourceRemarks {
  std::vector<state::Notice> notices;  ///< what was left out
  std::optional<std::string> damage;   ///< where it breaks off, one line
};

/// One method over one recording with one schedule of outages.
struct ExperimentRun {
  std::string recording;
  std::string imu;
  std::string method;
  double shift_s = 0;
  OutageSchedule schedule;
  SourceFactory open;
  EstimatorFactory make_estimator;
  OutageRunOptions options;
  std::shared_ptr<const SourceRemarks> remarks;  ///< filled by what open() gives; may be none
  bool needs_outage = false;                     ///< the recording is too short if no outage fits
  bool with_track = true;
  std::string depends_on;  ///< all that the result depends on, but for the above; any text
};

/// What the estimator of an experiment throws if it cannot go on; others may.
class EstimatorFailure : public DataError {
 public:
  using DataError::DataError;
};

/// What tells a run from others.
struct RunName {
  std::string recording;
  std::string imu;
  std::string method;
  double shift_s = 0;

  /// Whether both have the same outages.
  bool is_compared_with(const RunName& other) const {
    return recording == other.recording && imu == other.imu && shift_s == other.shift_s;
  }
};

struct ExperimentResult : RunName {
  OutageRunResult run;
  std::vector<TrackPoint> track;       ///< errors against the truth of `run`
  std::vector<state::Notice> notices;  ///< the first ones
  std::string failure;                 ///< of the estimator, one line; else empty
  SourceRemarks remarks;
};

/// Runs one of them. `progress` gets the part done; what it throws goes through. A run whose
/// estimator fails has nothing but its failure. Throws DataError if an outage is needed and none
/// fits, naming what to change.
ExperimentResult run_experiment(const ExperimentRun& run,
                                const std::function<void(double)>& progress);

/// Many runs, made when they are needed: they may be a million.
struct Experiment {
  std::size_t size = 0;
  std::function<ExperimentRun(std::size_t index)> run;  ///< from any thread
  std::function<RunName(std::size_t index)> name;       ///< of a run
  Batch batch;                                          ///< their records

  /// The batch, of which runs[index] depends on a text.
  void set_batch(const std::function<std::string(std::size_t index)>& depends_on);
};

Experiment experiment(std::vector<ExperimentRun> runs);

/// Of an experiment that is complete. Throws as run_experiment().
ExperimentResult result_of(const Experiment& experiment, std::size_t index, Executor& executor);

/// Runs all of them on `threads` threads; the results have the order of `runs` and, but for their
/// CPU times, do not depend on the number of threads. Throws as run_experiment().
std::vector<ExperimentResult> run_experiments(const std::vector<ExperimentRun>& runs, int threads,
                                              const std::function<void(double)>& progress = {});

/// One record an outage.
std::vector<DriftRecord> drift_records(const ExperimentResult& result);

}  // namespace foucault::evaluation
