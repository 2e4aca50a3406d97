#include "jobs/evaluation_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
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

/// An estimator does not know where its measurements come from; whoever reads its errors should.
template <class Work>
auto naming_recording(const std::string& recording, Work work) {
  try {
    return work();
  } catch (const UsageError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw evaluation::EstimatorFailure(fmt::format("{}: {}", recording, error.what()));
  }
}

class NamedEstimator : public state::Estimator {
 public:
  NamedEstimator(std::string name, std::unique_ptr<state::Estimator> estimator)
      : name_(std::move(name)), estimator_(std::move(estimator)) {}

  void process(const Measurement& measurement) override {
    naming_recording(name_, [&] { estimator_->process(measurement); });
  }
  void finish() override {
    naming_recording(name_, [&] { estimator_->finish(); });
  }

 private:
  std::string name_;
  std::unique_ptr<state::Estimator> estimator_;
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
  const auto shared = std::make_shared<const Settings>(settings);
  std::vector<EvaluationCase> cases;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (const std::string& method : methods) {
      cases.push_back({logs[i], names[i], settings.imu.preset, method, "", shared});
    }
  }
  return cases;
}

namespace {

/// A recording is too short if not even the outages of its least shift fit.
bool is_least_shift(const evaluation::OutageOptions& outages,
                    const evaluation::OutageSchedule& schedule) {
  return std::all_of(outages.shifts_s.begin(), outages.shifts_s.end(), [&](double other_s) {
    return schedule.first_end_s().value_or(0) <=
           evaluation::OutageSchedule(outages, other_s).first_end_s().value_or(0);
  });
}

std::string label_of(const EvaluationCase& c) {
  return c.label.empty() ? methods::find(c.method).name : c.label;
}

}  // namespace

evaluation::ExperimentRun experiment_run(const EvaluationCase& c, double shift_s,
                                         const std::shared_ptr<SharedLogs>& logs) {
  const methods::Method& method = methods::find(c.method);
  c.settings->imu.noise();
  evaluation::ExperimentRun run;
  run.recording = c.recording;
  run.imu = c.imu;
  run.method = label_of(c);
  run.shift_s = shift_s;
  run.schedule = evaluation::OutageSchedule(c.settings->outages, shift_s);
  run.needs_outage = is_least_shift(c.settings->outages, run.schedule);
  const auto remarks = std::make_shared<evaluation::SourceRemarks>();
  run.remarks = remarks;
  run.open = [logs, log = c.log, settings = c.settings, remarks] {
    return logs->open(log, *settings, remarks);
  };
  run.make_estimator = [make = method.make, settings = c.settings, name = c.recording](
                           const state::Mounting& mounting, state::Sink& sink) {
    return naming_recording(name, [&] {
      return std::make_unique<NamedEstimator>(name,
                                              make(method_options(*settings, mounting), sink));
    });
  };
  run.options.reference.keep_s = method.keep_references_s;
  run.options.layout = c.settings->calibrate.layout();
  return run;
}

std::vector<evaluation::ExperimentRun> experiment_runs(const EvaluationCase& c,
                                                       const std::shared_ptr<SharedLogs>& logs) {
  if (c.settings->outages.shifts_s.empty()) {
    throw UsageError("outages.shifts_s is empty; give at least one shift, such as [0]");
  }
  std::vector<evaluation::ExperimentRun> runs;
  for (const double shift_s : c.settings->outages.shifts_s) {
    runs.push_back(experiment_run(c, shift_s, logs));
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
  Settings settings = *whole.settings;
  for (const std::string& assignment : part.assignments) set_config(assignment, settings);
  c.settings = std::make_shared<const Settings>(std::move(settings));
  return c;
}

/// What logs show, each with each of the settings that it comes with, as records.
class Surveys {
 public:
  Surveys(const std::vector<EvaluationCase>& cases, RunStore& store, Console& console)
      : cases_(cases), store_(store) {
    read_logs(console);
    std::map<store::Key, std::size_t> known;
    for (std::size_t c = 0; c < cases.size(); ++c) {
      const store::Key key = key_of_case(c);
      const auto [at, is_new] = known.emplace(key, batch_.keys.size());
      if (is_new) {
        batch_.keys.push_back(key);
        first_case_.push_back(c);
      }
      of_case_.push_back(at->second);
    }
    batch_.compute = [this](std::size_t i, const evaluation::TaskProgress& progress) {
      progress(0);
      return store::Record{look_through(cases_[first_case_[i]]), 0};
    };
    if (store.runs().options().compute) {
      store.preparations().complete(batch_, console.progress_of("looking through"));
    } else {
      unknown_ = store.preparations().missing(batch_);
    }
  }

  /// How many nobody has made, where nothing is to be computed.
  std::size_t unknown() const { return unknown_; }
  std::size_t size() const { return batch_.keys.size(); }
  std::size_t of_case(std::size_t c) const { return of_case_[c]; }
  const std::string& content(std::size_t c) const { return contents_.at(cases_[c].log); }

  /// The settings with what the log shows, as settings_text() gives them.
  std::string text(std::size_t survey) const {
    return store_.preparations().get(batch_, survey).content;
  }

 private:
  void read_logs(Console& console) {
    std::map<std::string, const Settings*> settings_of_log;
    std::vector<std::string> logs;
    for (const EvaluationCase& c : cases_) {
      if (settings_of_log.emplace(c.log, c.settings.get()).second) logs.push_back(c.log);
    }
    const std::vector<std::string> contents = store_.contents(
        logs, [&](const std::string& log) { check_log(log, *settings_of_log.at(log)); }, console);
    for (std::size_t i = 0; i < logs.size(); ++i) contents_[logs[i]] = contents[i];
  }

  store::Key key_of_case(std::size_t c) {
    const auto [text, is_new] = texts_.try_emplace(cases_[c].settings.get());
    if (is_new) text->second = settings_text(*cases_[c].settings);
    return store::key_of(
        fmt::format("survey 1\n{}\n{}\n{}", store_.version(), content(c), text->second));
  }

  static std::string look_through(const EvaluationCase& c) {
    Console quiet(true);
    return settings_text(Surveyor(quiet).complete(c.log, settings_for(c.log, *c.settings)));
  }

  const std::vector<EvaluationCase>& cases_;
  RunStore& store_;
  std::map<std::string, std::string> contents_;
  std::map<const Settings*, std::string> texts_;
  evaluation::Batch batch_;
  std::vector<std::size_t> first_case_;
  std::vector<std::size_t> of_case_;
  std::size_t unknown_ = 0;
};

/// One method on one log with one shift.
struct Place {
  std::size_t c;  ///< the case
  double shift_s;
};

/// Those that are compared follow each other, so that nobody has to keep results until the others
/// come: by recording, in order of appearance, by shift, by case.
std::vector<Place> places_of(const std::vector<EvaluationCase>& cases) {
  std::map<std::string, std::size_t> first;
  std::vector<std::size_t> ordered;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    first.emplace(cases[c].recording, c);
    ordered.push_back(c);
  }
  const auto first_of = [&](std::size_t c) { return first.at(cases[c].recording); };
  std::stable_sort(ordered.begin(), ordered.end(),
                   [&](std::size_t a, std::size_t b) { return first_of(a) < first_of(b); });
  std::vector<Place> places;
  for (std::size_t begin = 0, end = 0; begin < ordered.size(); begin = end) {
    std::vector<double> shifts_s;
    for (end = begin; end < ordered.size() && first_of(ordered[end]) == first_of(ordered[begin]);
         ++end) {
      for (const double shift_s : cases[ordered[end]].settings->outages.shifts_s) {
        if (std::find(shifts_s.begin(), shifts_s.end(), shift_s) == shifts_s.end())
          shifts_s.push_back(shift_s);
      }
    }
    for (const double shift_s : shifts_s) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::vector<double>& own_s = cases[ordered[k]].settings->outages.shifts_s;
        if (std::find(own_s.begin(), own_s.end(), shift_s) != own_s.end())
          places.push_back({ordered[k], shift_s});
      }
    }
  }
  return places;
}

/// Names of runs, for those who outlive the runs.
struct CaseNames {
  std::vector<evaluation::RunName> of_case;  ///< without their shifts
  std::vector<Place> places;

  evaluation::RunName at(std::size_t run) const {
    evaluation::RunName name = of_case[places[run].c];
    name.shift_s = places[run].shift_s;
    return name;
  }
};

/// All runs of an evaluation.
class EvaluationRuns {
 public:
  EvaluationRuns(const std::vector<EvaluationCase>& cases, RunStore& store, Console& console)
      : cases_(cases), store_(store), surveys_(cases, store, console) {
    if (surveys_.unknown() > 0) {
      throw DataError(fmt::format(
          "--no-compute: {} of {} logs were not looked through yet, so that all of their runs are "
          "missing; wait for the workers, or give the same command without --no-compute",
          surveys_.unknown(), surveys_.size()));
    }
    find_settings();
    CaseNames names{{}, places_of(cases)};
    for (std::size_t c = 0; c < cases.size(); ++c) {
      names.of_case.push_back({cases[c].recording, imu(c), label_of(cases[c]), 0});
    }
    names_ = std::make_shared<const CaseNames>(std::move(names));
    choose_tracks();
  }

  evaluation::Experiment experiment() const {
    evaluation::Experiment experiment;
    experiment.size = names_->places.size();
    experiment.run = [this](std::size_t i) { return run(i); };
    experiment.name = [names = names_](std::size_t i) { return names->at(i); };
    experiment.set_batch([this](std::size_t i) { return depends_on(i); });
    return experiment;
  }

 private:
  /// The IMU, and a hash in the place of a text of some kilobytes.
  struct Shown {
    std::string imu;
    std::string hash;
  };

  void find_settings() {
    for (std::size_t i = 0; i < surveys_.size(); ++i) {
      const std::string text = surveys_.text(i);
      shown_.push_back({settings_of(text, {0}).imu.preset, store::hex(store::key_of(text))});
    }
  }

  std::string imu(std::size_t c) const {
    const std::string& given = cases_[c].imu;
    return given == imu::ImuOptions::kAsRecorded ? shown_[surveys_.of_case(c)].imu : given;
  }

  void choose_tracks() {
    const std::vector<evaluation::RunName>& names = names_->of_case;
    const bool several_imus =
        std::any_of(names.begin(), names.end(),
                    [&](const evaluation::RunName& name) { return name.imu != names.front().imu; });
    evaluation::ShownRuns shown(several_imus);
    for (std::size_t i = 0; i < names_->places.size(); ++i) {
      tracks_.push_back(shown.place(names_->at(i)).has_value());
    }
  }

  evaluation::ExperimentRun run(std::size_t i) const {
    const auto [case_index, shift_s] = names_->places[i];
    EvaluationCase c = cases_[case_index];
    c.imu = names_->of_case[case_index].imu;
    c.settings = std::make_shared<const Settings>(
        settings_of(surveys_.text(surveys_.of_case(case_index)), c.settings->outages.shifts_s));
    evaluation::ExperimentRun run = experiment_run(c, shift_s, logs_);
    run.with_track = tracks_[i];
    return run;
  }

  std::string depends_on(std::size_t i) const {
    const auto [c, shift_s] = names_->places[i];
    return run_text(store_, surveys_.content(c), cases_[c].method, shift_s, tracks_[i],
                    shown_[surveys_.of_case(c)].hash);
  }

  const std::vector<EvaluationCase>& cases_;
  RunStore& store_;
  Surveys surveys_;
  std::shared_ptr<SharedLogs> logs_ = std::make_shared<SharedLogs>();
  std::vector<Shown> shown_;
  std::shared_ptr<const CaseNames> names_;
  std::vector<bool> tracks_;
};

void check_all(const std::vector<EvaluationCase>& cases) {
  for (const EvaluationCase& c : cases) experiment_runs(c);
}

/// The runs of some methods, or of all others.
evaluation::RunNames names_if(const evaluation::Experiment& experiment,
                              const std::set<std::string>& methods, bool are_wanted) {
  const auto runs = std::make_shared<std::vector<std::size_t>>();
  for (std::size_t i = 0; i < experiment.size; ++i) {
    if ((methods.count(experiment.name(i).method) > 0) == are_wanted) runs->push_back(i);
  }
  return {runs->size(),
          [runs, name = experiment.name](std::size_t i) { return name(runs->at(i)); }};
}

/// One reading of all records: tables and drift.csv come about while results come and go.
class Gathering {
 public:
  /// Without those methods that are known to fail.
  Gathering(const evaluation::Experiment& experiment,
            const std::vector<evaluation::AblationCase>& ablation,
            const std::set<std::string>& left_out, const std::filesystem::path& folder,
            Console& console)
      : experiment_(experiment),
        left_out_(left_out),
        drifts_(folder / "drift.csv"),
        summary_(names_if(experiment, left_out, false)),
        console_(console) {
    for (const evaluation::AblationCase& what : ablation) {
      if (what.without.empty() && is_wanted(what.label())) whole_.insert(what.label());
    }
    if (!whole_.empty()) as_configured_.emplace(names_if(experiment, whole_, true));
  }

  void read(evaluation::Executor& executor) {
    for (std::size_t i = 0; i < experiment_.size; ++i) {
      console_.progress("gathering",
                        static_cast<double>(i) / static_cast<double>(experiment_.size));
      if (is_wanted(experiment_.name(i).method)) {
        add(evaluation::result_of(experiment_, i, executor));
      }
    }
    drifts_.close();
  }

  /// Methods and a line for each of their runs that failed; with any of them nothing else is whole.
  const std::vector<std::pair<std::string, std::string>>& failures() const { return failures_; }

  Evaluation result() {
    Evaluation evaluation;
    summary_.finish();
    if (as_configured_) as_configured_->finish();
    evaluation.summary = std::move(summary_);
    evaluation.as_configured = std::move(as_configured_);
    for (const auto& [recording, damage] : damages_) {
      if (damage) evaluation.damages.push_back(*damage);
    }
    return evaluation;
  }

 private:
  bool is_wanted(const std::string& method) const { return left_out_.count(method) == 0; }

  void add(evaluation::ExperimentResult result) {
    if (!result.failure.empty()) {
      failures_.emplace_back(result.method,
                             fmt::format("method {}: {}", result.method, result.failure));
      return;
    }
    note_remarks(result);
    warn(result, console_);
    if (!failures_.empty()) return;
    drifts_.add(result);
    if (whole_.count(result.method) > 0) as_configured_->add(result);
    summary_.add(std::move(result));
  }

  /// Of a recording, by whichever of its runs comes first.
  void note_remarks(const evaluation::ExperimentResult& result) {
    if (!damages_.emplace(result.recording, result.remarks.damage).second) return;
    warn(result.recording, result.remarks.notices, console_);
  }

  const evaluation::Experiment& experiment_;
  const std::set<std::string>& left_out_;
  exports::DriftFile drifts_;
  evaluation::EvaluationSummary summary_;
  std::set<std::string> whole_;
  std::optional<evaluation::EvaluationSummary> as_configured_;
  std::vector<std::pair<std::string, std::string>> failures_;
  std::map<std::string, std::optional<std::string>> damages_;
  Console& console_;
};

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
    for (const Part& part : parts_of(*c.settings)) add(without(part, c), part.name);
  }
  if (ablation.cases.size() == cases.size()) {
    throw UsageError(
        "--ablate: nothing can be switched off; the configuration uses no aid and estimates "
        "nothing beside the biases (sections aids and calibrate)");
  }
  return ablation;
}

void check_log(const std::string& log, const Settings& settings) {
  rawlog::RawlogSource(log, settings.imu.sample_kind(), settings.rawlog);
}

Evaluation gather(const evaluation::Experiment& experiment,
                  const std::vector<evaluation::AblationCase>& ablation,
                  evaluation::Executor& executor, const std::filesystem::path& folder,
                  Console& console) {
  std::set<std::string> failed;
  std::vector<std::string> failures;
  while (true) {
    Gathering gathering(experiment, ablation, failed, folder, console);
    gathering.read(executor);
    for (const auto& [method, line] : gathering.failures()) {
      failed.insert(method);
      failures.push_back(line);
    }
    if (gathering.failures().empty()) {
      Evaluation evaluation = gathering.result();
      evaluation.failures = std::move(failures);
      return evaluation;
    }
    if (names_if(experiment, failed, false).size == 0) throw DataError(failures.front());
  }
}

Evaluation evaluate_what_is_there(const Ablation& ablation, RunStore& store,
                                  const std::filesystem::path& folder, Console& console) {
  check_all(ablation.cases);
  const EvaluationRuns runs(ablation.cases, store, console);
  const evaluation::Experiment experiment = runs.experiment();
  store.runs().complete(experiment.batch, console.progress_of("evaluating"));
  if (store.is_worker()) {
    store.report(experiment.size, console);
    return {};
  }
  Evaluation evaluation = gather(experiment, ablation.names, store.runs(), folder, console);
  store.report(experiment.size, console);
  return evaluation;
}

evaluation::EvaluationSummary evaluate(const std::vector<EvaluationCase>& cases, RunStore& store,
                                       const std::filesystem::path& folder, Console& console) {
  Evaluation evaluation = evaluate_what_is_there({cases}, store, folder, console);
  if (!evaluation.damages.empty()) throw DataError(evaluation.damages.front());
  if (!evaluation.failures.empty()) throw DataError(evaluation.failures.front());
  return std::move(*evaluation.summary);
}

void write_evaluation(const Evaluation& evaluation, const EvaluationLabels& labels,
                      bool with_report, const std::filesystem::path& folder, Console& console) {
  const evaluation::EvaluationSummary& summary = *evaluation.summary;
  exports::write_evaluation(summary, labels.origin, folder,
                            evaluation::ablation_rows(summary.overall(), labels.ablation));
  if (!with_report) return;
  console.progress("drawing", 0);
  const content::EvaluationReport report =
      labels.ablation.empty()
          ? evaluation_report(summary, labels)
          : ablation_report(summary, evaluation.as_configured ? *evaluation.as_configured : summary,
                            labels);
  page::write_report(content::evaluation_page(report), (folder / "report").string());
}

}  // namespace foucault::app
