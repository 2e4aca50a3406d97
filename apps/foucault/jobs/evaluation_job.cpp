#include "jobs/evaluation_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/page/report_page.h"
#include "foucault/rawlog/rawlog_source.h"
#include "jobs/survey.h"
#include "methods.h"

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

std::unique_ptr<rawlog::RawlogSource> open_log(const std::string& log, const Settings& settings) {
  return std::make_unique<rawlog::RawlogSource>(log, settings.imu.sample_kind(), settings.rawlog);
}

/// An estimator does not know where its measurements come from; whoever reads its errors should.
class NamedEstimator : public state::Estimator {
 public:
  NamedEstimator(std::string name, std::unique_ptr<state::Estimator> estimator)
      : name_(std::move(name)), estimator_(std::move(estimator)) {}

  void process(const Measurement& measurement) override {
    naming([&] { estimator_->process(measurement); });
  }
  void finish() override {
    naming([&] { estimator_->finish(); });
  }

 private:
  template <class Work>
  void naming(Work work) const {
    try {
      work();
    } catch (const UsageError&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      throw evaluation::EstimatorFailure(fmt::format("{}: {}", name_, error.what()));
    }
  }

  std::string name_;
  std::unique_ptr<state::Estimator> estimator_;
};

/// For comparisons that mean nothing unless the log is whole.
class WholeSource : public state::Source {
 public:
  explicit WholeSource(std::unique_ptr<rawlog::RawlogSource> source) : source_(std::move(source)) {}

  std::optional<Measurement> next() override {
    std::optional<Measurement> measurement = source_->next();
    if (!measurement && source_->damage()) throw DataError(*source_->damage());
    return measurement;
  }
  const state::Mounting& mounting() const override { return source_->mounting(); }
  double progress() const override { return source_->progress(); }

 private:
  std::unique_ptr<rawlog::RawlogSource> source_;
};

/// What was left out of each log and where it broke off, from whichever of its readers came to the
/// end.
class LogNotices {
 public:
  void put(const std::string& recording, const rawlog::RawlogSource& source) {
    const std::lock_guard<std::mutex> lock(mutex_);
    notices_.emplace(recording, source.notices());
    if (source.damage()) damages_.emplace(recording, *source.damage());
  }
  const std::map<std::string, std::vector<state::Notice>>& notices() const { return notices_; }
  std::vector<std::string> damages() const {
    std::vector<std::string> damages;
    for (const auto& [recording, damage] : damages_) damages.push_back(damage);
    return damages;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::vector<state::Notice>> notices_;
  std::map<std::string, std::string> damages_;
};

class NotingSource : public state::Source {
 public:
  NotingSource(std::unique_ptr<rawlog::RawlogSource> source, std::string recording,
               LogNotices& notices)
      : source_(std::move(source)), recording_(std::move(recording)), notices_(notices) {}

  std::optional<Measurement> next() override {
    std::optional<Measurement> measurement = source_->next();
    if (!measurement) notices_.put(recording_, *source_);
    return measurement;
  }
  const state::Mounting& mounting() const override { return source_->mounting(); }
  double progress() const override { return source_->progress(); }

 private:
  std::unique_ptr<rawlog::RawlogSource> source_;
  std::string recording_;
  LogNotices& notices_;
};

void warn(const std::string& recording, const std::vector<state::Notice>& notices,
          Console& console) {
  for (const state::Notice& notice : notices) {
    if (notice.kind == state::NoticeKind::aligned) continue;
    console.warn(fmt::format("{}: {}: {}", recording, utc_text(notice.t_ns), notice.text));
  }
}

void warn(const evaluation::ExperimentResult& result, Console& console) {
  warn(result.recording, result.notices, console);
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

std::vector<evaluation::ExperimentRun> experiment_runs(const EvaluationCase& evaluation_case) {
  const Settings& settings = evaluation_case.settings;
  const Method& method = find_method(evaluation_case.method);
  settings.imu.noise();
  if (settings.outages.shifts_s.empty()) {
    throw UsageError("outages.shifts_s is empty; give at least one shift, such as [0]");
  }
  std::vector<evaluation::ExperimentRun> runs;
  for (const double shift_s : settings.outages.shifts_s) {
    evaluation::ExperimentRun run;
    run.recording = evaluation_case.recording;
    run.imu = evaluation_case.imu;
    run.method = evaluation_case.label.empty() ? method.name : evaluation_case.label;
    run.shift_s = shift_s;
    run.schedule = evaluation::OutageSchedule(settings.outages, shift_s);
    run.open = [log = evaluation_case.log, settings] {
      return std::make_unique<WholeSource>(open_log(log, settings));
    };
    run.make_estimator = [make = method.make, settings, name = run.recording](
                             const state::Mounting& mounting, state::Sink& sink) {
      return std::make_unique<NamedEstimator>(name, make(settings, mounting, sink));
    };
    run.options.reference.keep_s = method.keep_references_s;
    run.options.layout = settings.calibrate.layout();
    runs.push_back(std::move(run));
  }
  return runs;
}

namespace {

/// What can be switched off, and how.
struct Part {
  std::string name;
  std::vector<std::string> assignments;
};

std::vector<Part> parts_of(const Settings& settings) {
  const std::string no_aids = "aids.mode=none", no_calibration = "calibrate.mode=none";
  const bool calibrates = settings.calibrate.resolved({true, true}).layout().slow_size() > 0;
  std::vector<Part> parts;
  for (const std::string& aid : settings.aids.in_use()) {
    parts.push_back({aid, {fmt::format("aids.{}=off", aid)}});
  }
  const bool aided = !parts.empty();
  if (aided) parts.push_back({"aids", {no_aids}});
  if (calibrates) parts.push_back({"calibration", {no_calibration}});
  if (aided && calibrates) parts.push_back({"aids and calibration", {no_aids, no_calibration}});
  return parts;
}

EvaluationCase without(const Part& part, const EvaluationCase& whole) {
  EvaluationCase c = whole;
  c.label = evaluation::AblationCase{whole.method, part.name}.label();
  for (const std::string& assignment : part.assignments) set_config(assignment, c.settings);
  return c;
}

/// With what the logs say, once the settings are known to be right.
std::vector<EvaluationCase> with_notes(std::vector<EvaluationCase> cases, Console& console) {
  for (const EvaluationCase& c : cases) experiment_runs(c);
  // A log is the same for all methods; what it shows depends on the aids.
  std::map<std::vector<std::string>, Surveyor> surveyors;
  for (EvaluationCase& c : cases) {
    Surveyor& surveyor = surveyors.try_emplace(c.settings.aids.in_use(), console).first->second;
    c.settings = surveyor.complete(c.log, settings_for(c.log, c.settings));
    if (c.imu == imu::ImuOptions::kAsRecorded) c.imu = c.settings.imu.preset;
  }
  return cases;
}

}  // namespace

Ablation with_parts_off(const std::vector<EvaluationCase>& cases) {
  Ablation ablation;
  const auto add = [&](const EvaluationCase& c, const std::string& part) {
    ablation.cases.push_back(c);
    const evaluation::AblationCase what{c.method, part};
    const bool is_new =
        std::none_of(ablation.names.begin(), ablation.names.end(),
                     [&](const auto& name) { return name.label() == what.label(); });
    if (is_new) ablation.names.push_back(what);
  };
  for (const EvaluationCase& c : cases) {
    add(c, "");
    for (const Part& part : parts_of(c.settings)) add(without(part, c), part.name);
  }
  if (ablation.cases.size() == cases.size()) {
    throw UsageError(
        "--ablate: nothing can be switched off; the configuration uses no aid and estimates "
        "nothing beside the biases (sections aids and calibrate)");
  }
  return ablation;
}

void check_logs(const std::vector<std::string>& logs, const Settings& settings) {
  for (const std::string& log : logs) open_log(log, settings);
}

Evaluation evaluate_what_is_there(const std::vector<EvaluationCase>& given, int threads,
                                  Console& console) {
  const std::vector<EvaluationCase> cases = with_notes(given, console);
  LogNotices notices;
  std::vector<evaluation::ExperimentRun> runs;
  for (const EvaluationCase& c : cases) {
    for (evaluation::ExperimentRun& run : experiment_runs(c)) {
      run.open = [&notices, c] {
        return std::make_unique<NotingSource>(open_log(c.log, c.settings), c.recording, notices);
      };
      runs.push_back(std::move(run));
    }
  }
  for (const EvaluationCase& c : cases) check_logs({c.log}, c.settings);
  Evaluation evaluation;
  evaluation.results =
      evaluation::run_experiments(runs, threads, console.progress_of("evaluating"));
  evaluation.failures = evaluation::take_out_failed(evaluation.results);
  if (evaluation.results.empty()) throw DataError(evaluation.failures.front());
  evaluation.damages = notices.damages();
  for (const auto& [recording, of_log] : notices.notices()) warn(recording, of_log, console);
  for (const evaluation::ExperimentResult& result : evaluation.results) warn(result, console);
  return evaluation;
}

std::vector<evaluation::ExperimentResult> evaluate(const std::vector<EvaluationCase>& cases,
                                                   int threads, Console& console) {
  Evaluation evaluation = evaluate_what_is_there(cases, threads, console);
  if (!evaluation.damages.empty()) throw DataError(evaluation.damages.front());
  if (!evaluation.failures.empty()) throw DataError(evaluation.failures.front());
  return std::move(evaluation.results);
}

void write_evaluation(const evaluation::EvaluationSummary& summary, const EvaluationLabels& labels,
                      bool with_report, const std::filesystem::path& folder, Console& console) {
  exports::write_evaluation(summary, labels.origin, folder,
                            evaluation::ablation_rows(summary.overall(), labels.ablation));
  if (!with_report) return;
  console.progress("drawing", 0);
  page::write_report(content::evaluation_page(evaluation_report(summary, labels)),
                     (folder / "report").string());
}

}  // namespace foucault::app
