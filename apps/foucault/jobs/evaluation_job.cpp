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
    for (std::size_t c = 0; c < cases.size(); ++c) {
      for (const double shift_s : cases[c].settings->outages.shifts_s)
        places_.push_back({c, shift_s});
    }
  }

  evaluation::Experiment experiment() const {
    evaluation::Experiment experiment;
    experiment.size = places_.size();
    experiment.run = [this](std::size_t i) { return run(places_[i]); };
    experiment.named = [this](std::size_t i) { return named(places_[i]); };
    ShownRuns shown(several_imus());
    experiment.set_batch([&](std::size_t i) {
      const evaluation::ExperimentResult name = named(places_[i]);
      tracks_.push_back(shown.place(name).has_value());
      return depends_on(places_[i], tracks_.back());
    });
    return experiment;
  }

 private:
  struct Place {
    std::size_t c;
    double shift_s;
  };

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

  bool several_imus() const {
    for (std::size_t c = 1; c < cases_.size(); ++c) {
      if (imu(c) != imu(0)) return true;
    }
    return false;
  }

  evaluation::ExperimentResult named(const Place& place) const {
    evaluation::ExperimentResult result;
    result.recording = cases_[place.c].recording;
    result.imu = imu(place.c);
    result.method = label_of(cases_[place.c]);
    result.shift_s = place.shift_s;
    return result;
  }

  evaluation::ExperimentRun run(const Place& place) const {
    EvaluationCase c = cases_[place.c];
    c.imu = imu(place.c);
    c.settings = std::make_shared<const Settings>(
        settings_of(surveys_.text(surveys_.of_case(place.c)), c.settings->outages.shifts_s));
    evaluation::ExperimentRun run = experiment_run(c, place.shift_s, logs_);
    run.with_track = tracks_[static_cast<std::size_t>(&place - places_.data())];
    return run;
  }

  std::string depends_on(const Place& place, bool with_track) const {
    return run_text(store_, surveys_.content(place.c), cases_[place.c].method, place.shift_s,
                    with_track, shown_[surveys_.of_case(place.c)].hash);
  }

  const std::vector<EvaluationCase>& cases_;
  RunStore& store_;
  Surveys surveys_;
  std::shared_ptr<SharedLogs> logs_ = std::make_shared<SharedLogs>();
  std::vector<Shown> shown_;
  std::vector<Place> places_;
  mutable std::vector<bool> tracks_;
};

void check_all(const std::vector<EvaluationCase>& cases) {
  for (const EvaluationCase& c : cases) experiment_runs(c);
}

/// Of a recording, by whichever of its runs comes first.
void note_remarks(const evaluation::ExperimentResult& result,
                  std::map<std::string, std::optional<std::string>>& damages, Console& console) {
  if (!result.failure.empty()) return;
  if (!damages.emplace(result.recording, result.remarks.damage).second) return;
  warn(result.recording, result.remarks.notices, console);
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

Evaluation evaluate_what_is_there(const std::vector<EvaluationCase>& cases, RunStore& store,
                                  Console& console) {
  check_all(cases);
  const EvaluationRuns runs(cases, store, console);
  const evaluation::Experiment experiment = runs.experiment();
  store.runs().complete(experiment.batch, console.progress_of("evaluating"));
  Evaluation evaluation;
  std::map<std::string, std::optional<std::string>> damages;
  for (std::size_t i = 0; i < experiment.size && !store.is_worker(); ++i) {
    console.progress("gathering", static_cast<double>(i) / static_cast<double>(experiment.size));
    evaluation.results.push_back(evaluation::result_of(experiment, i, store.runs()));
    note_remarks(evaluation.results.back(), damages, console);
    evaluation.results.back().remarks = {};
  }
  store.report(experiment.size, console);
  if (store.is_worker()) return evaluation;
  evaluation.failures = evaluation::take_out_failed(evaluation.results);
  if (evaluation.results.empty()) throw DataError(evaluation.failures.front());
  for (const auto& [recording, damage] : damages) {
    if (damage) evaluation.damages.push_back(*damage);
  }
  for (const evaluation::ExperimentResult& result : evaluation.results) warn(result, console);
  return evaluation;
}

std::vector<evaluation::ExperimentResult> evaluate(const std::vector<EvaluationCase>& cases,
                                                   RunStore& store, Console& console) {
  Evaluation evaluation = evaluate_what_is_there(cases, store, console);
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
