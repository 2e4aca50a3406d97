#include "evaluation_job.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/rawlog/rawlog_source.h"
#include "methods.h"
#include "units.h"

namespace foucault::app {
namespace {

void refuse_doubles(const std::vector<std::string>& names, const char* what) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (seen.insert(name).second) continue;
    throw UsageError(fmt::format("{} '{}' is given twice; name each once", what, name));
  }
}

/// File names without folder and extension; with them where that would not tell them apart.
std::vector<std::string> recording_names(const std::vector<std::string>& logs) {
  std::map<std::string, int> count;
  for (const std::string& log : logs) ++count[std::filesystem::path(log).stem().string()];
  std::vector<std::string> names;
  for (const std::string& log : logs) {
    const std::string stem = std::filesystem::path(log).stem().string();
    names.push_back(count.at(stem) == 1 ? stem : log);
  }
  return names;
}

std::unique_ptr<RawlogSource> open_log(const std::string& log, const Settings& settings) {
  return std::make_unique<RawlogSource>(log, settings.imu.sample_kind(), settings.rawlog);
}

/// An estimator that gives out at its end needs all references till then.
constexpr double kKeepReferences = 1e7;  // [s]

void warn(const ExperimentResult& result, Console& console) {
  for (const Notice& notice : result.notices) {
    if (notice.kind == NoticeKind::aligned) continue;
    console.warn(fmt::format("{}: {}: {}", result.recording, format_utc(notice.t_ns), notice.text));
  }
  const int64_t missing = result.run.scheduled - static_cast<int64_t>(result.run.drifts.size());
  if (missing > 0) {
    console.warn(fmt::format(
        "{}: {} gave nothing to measure in {} of {} outages (shift {} s); they are left out for "
        "every method",
        result.recording, result.method, missing, result.run.scheduled, result.shift_s));
  }
}

}  // namespace

std::vector<EvaluationCase> cross(const std::vector<std::string>& logs,
                                  const std::vector<std::string>& methods,
                                  const Settings& settings) {
  refuse_doubles(logs, "log");
  refuse_doubles(methods, "method");
  const std::vector<std::string> names = recording_names(logs);
  std::vector<EvaluationCase> cases;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (const std::string& method : methods) {
      cases.push_back({logs[i], names[i], settings.imu.preset, method, "", settings});
    }
  }
  return cases;
}

std::vector<ExperimentRun> experiment_runs(const EvaluationCase& evaluation_case) {
  const Settings& settings = evaluation_case.settings;
  const Method& method = find_method(evaluation_case.method);
  settings.imu.noise();
  if (settings.outages.shifts_s.empty()) {
    throw UsageError("outages.shifts_s is empty; give at least one shift, such as [0]");
  }
  std::vector<ExperimentRun> runs;
  for (const double shift_s : settings.outages.shifts_s) {
    ExperimentRun run;
    run.recording = evaluation_case.recording;
    run.imu = evaluation_case.imu;
    run.method = evaluation_case.label.empty() ? method.name : evaluation_case.label;
    run.shift_s = shift_s;
    run.schedule = OutageSchedule(settings.outages, shift_s);
    run.open = [log = evaluation_case.log, settings] { return open_log(log, settings); };
    run.make_estimator = [make = method.make, settings](const Mounting& mounting, Sink& sink) {
      return make(settings, mounting, sink);
    };
    run.options.reference.keep_s = kKeepReferences;
    runs.push_back(std::move(run));
  }
  return runs;
}

void check_logs(const std::vector<std::string>& logs, const Settings& settings) {
  for (const std::string& log : logs) open_log(log, settings);
}

std::vector<ExperimentResult> evaluate(const std::vector<EvaluationCase>& cases, int threads,
                                       Console& console) {
  std::vector<ExperimentRun> runs;
  for (const EvaluationCase& c : cases) {
    for (ExperimentRun& run : experiment_runs(c)) runs.push_back(std::move(run));
  }
  for (const EvaluationCase& c : cases) check_logs({c.log}, c.settings);
  const std::vector<ExperimentResult> results =
      run_experiments(runs, threads, console.progress_of("evaluating"));
  for (const ExperimentResult& result : results) warn(result, console);
  return results;
}

}  // namespace foucault::app
