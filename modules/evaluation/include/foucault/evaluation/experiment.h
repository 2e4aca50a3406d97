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

struct ExperimentResult {
  std::string recording;
  std::string imu;
  std::string method;
  double shift_s = 0;
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
  std::function<ExperimentRun(std::size_t index)> run;       ///< from any thread
  std::function<ExperimentResult(std::size_t index)> named;  ///< a result with the names of a run
  Batch batch;                                               ///< their records

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

/// Takes out the methods that failed in any of their runs, since what is left of them would be
/// compared with others on other outages. Gives a line for each failure.
std::vector<std::string> take_out_failed(std::vector<ExperimentResult>& results);

/// What runs are joined by: those of one IMU, of one recording, or all.
enum class Grouping { imu, recording, all };

/// A place of a table: all outages of one method in one group.
struct MethodOutages {
  struct Entry {
    const ExperimentResult* run;  ///< points into the results
    const OutageDrift* drift;
  };

  std::string group;
  std::string method;
  std::vector<Entry> entries;  ///< the same outages in the same order for each method of a group
  int64_t missing = 0;         ///< scheduled outages in which this method gave nothing to measure
  double cpu_s = 0;            ///< of all its runs

  std::vector<double> horizontal_max() const;  ///< [m]
  std::vector<double> vertical_max() const;
};

/// Groups and methods in order of appearance, groups first. An outage that a method of the group
/// misses is left out for all of them. The results must outlive what is returned.
std::vector<MethodOutages> group_outages(const std::vector<ExperimentResult>& results,
                                         Grouping grouping);

/// For tables. Those without outages are left out.
std::vector<MethodDrifts> method_drifts(const std::vector<MethodOutages>& outages);

/// One record an outage and method, in the order of the results.
std::vector<DriftRecord> drift_records(const std::vector<ExperimentResult>& results);

/// The rows of Table III: by IMU if there are several, else by recording with a last row
/// "all recordings" if there are several of these.
std::vector<MethodOutages> table_rows(const std::vector<ExperimentResult>& results);

}  // namespace foucault::evaluation
