#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/evaluation/experiment.h"
#include "jobs/run_store.h"
#include "jobs/shared_logs.h"
#include "pages/evaluation_page.h"
#include "settings.h"

namespace foucault::app {

/// One method on one log; settings->outages.shifts_s make a run each.
struct EvaluationCase {
  std::string log;                           ///< rawlog
  std::string recording;                     ///< its name in tables
  std::string imu;                           ///< recordings of one IMU are joined in tables
  std::string method;                        ///< see methods::all()
  std::string label;                         ///< of the method in tables; empty: its name
  std::shared_ptr<const Settings> settings;  ///< one for many cases, which may be a million
};

/// Every method on every log with the same settings; recordings are named by their files.
/// Throws UsageError if a log or method is given twice.
std::vector<EvaluationCase> cross(const std::vector<std::string>& logs,
                                  const std::vector<std::string>& methods,
                                  const Settings& settings);

/// Cases, and the names of their methods if they are those of an ablation.
struct Ablation {
  std::vector<EvaluationCase> cases;
  std::vector<evaluation::AblationCase> names = {};
};

/// Each case, and behind it the same with each aid off that it uses, with all aids off, without
/// calibration, and without both. Throws UsageError if there is nothing to switch off.
Ablation with_parts_off(const std::vector<EvaluationCase>& cases);

/// The run of a case with one of its shifts. Throws UsageError for settings that make no sense.
evaluation::ExperimentRun experiment_run(const EvaluationCase& evaluation_case, double shift_s,
                                         const std::shared_ptr<SharedLogs>& logs);
/// One a shift.
std::vector<evaluation::ExperimentRun> experiment_runs(
    const EvaluationCase& evaluation_case,
    const std::shared_ptr<SharedLogs>& logs = std::make_shared<SharedLogs>());

/// Opens a log: what is missing or no rawlog shows before hours are spent on others.
void check_log(const std::string& log, const Settings& settings);

/// What came out of many runs.
struct Evaluation {
  std::optional<evaluation::EvaluationSummary> summary;  ///< a worker has none
  /// Of an ablation: of the cases with the configuration as it is, if any has results.
  std::optional<evaluation::EvaluationSummary> as_configured = {};
  /// Logs that break off, a line each; results are up to there.
  std::vector<std::string> damages = {};
  /// Of methods, a line each; they have no results.
  std::vector<std::string> failures = {};
};

/// Reads the records of all runs, those of compared runs one after the other, and writes drift.csv
/// into `folder` meanwhile; keeps of them what the summary needs. Throws DataError, also if every
/// method failed, Interrupted.
Evaluation gather(const evaluation::Experiment& experiment,
                  const std::vector<evaluation::AblationCase>& ablation,
                  evaluation::Executor& executor, const std::filesystem::path& folder,
                  Console& console);

/// Runs all cases and writes drift.csv into `folder`, run by run: by recording, shift, case. A
/// worker writes nothing: its share of the runs is in the store. Says what users should know about
/// the data. Throws DataError, also if every method failed, UsageError, Interrupted.
Evaluation evaluate_what_is_there(const Ablation& ablation, RunStore& store,
                                  const std::filesystem::path& folder, Console& console);

/// The same with a DataError for a log that breaks off and a method that fails.
evaluation::EvaluationSummary evaluate(const std::vector<EvaluationCase>& cases, RunStore& store,
                                       const std::filesystem::path& folder, Console& console);

/// The other files of an evaluation, and its report if it is asked for.
void write_evaluation(const Evaluation& evaluation, const EvaluationLabels& labels,
                      bool with_report, const std::filesystem::path& folder, Console& console);

}  // namespace foucault::app
