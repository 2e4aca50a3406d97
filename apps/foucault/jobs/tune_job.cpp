#include "jobs/tune_job.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <mutex>

#include "foucault/core/error.h"
#include "foucault/page/report_page.h"
#include "foucault/tuning/tuning_output.h"
#include "jobs/evaluation_job.h"
#include "jobs/survey.h"
#include "methods.h"
#include "output_directory.h"
#include "pages/tuning_page.h"
#include "version.h"

namespace foucault::app {
namespace {

tuning::Tunable tunable(Settings& base) {
  const auto try_on = [&base](const std::string& assignment) {
    Settings settings = base;
    set_config(assignment, settings);
    settings.imu.noise();
  };
  return {base, try_on, [](const std::string& method) { methods::find(method); }, methods::names()};
}

std::string base_text(const TuneJob& job) {
  Settings base = job.base;
  return dump_config(base);
}

void check(const TuneJob& job) {
  for (const EvaluationCase& c : cross(job.logs, job.config.methods, job.base)) experiment_runs(c);
}

/// Makes the runs of points, from any thread.
class PointMaker {
 public:
  PointMaker(const TuneJob& job, RunStore& store, Console& console)
      : job_(job), store_(store), surveyor_(console) {
    const std::vector<std::string> contents = store.contents(
        job.logs, [&](const std::string& log) { check_log(log, job.base); }, console);
    for (std::size_t i = 0; i < job.logs.size(); ++i) contents_[job.logs[i]] = contents[i];
  }

  std::vector<evaluation::ExperimentRun> runs(const std::string& log, const std::string& method,
                                              const tuning::GridPoint& point) {
    const auto settings = std::make_shared<const Settings>(completed(log, point));
    const std::string text = store::hex(store::key_of(settings_text(*settings)));
    std::vector<evaluation::ExperimentRun> runs =
        experiment_runs({log, log, settings->imu.preset, method, "", settings}, logs_);
    for (evaluation::ExperimentRun& run : runs) {
      run.with_track = false;
      run.depends_on = run_text(store_, contents_.at(log), method, run.shift_s, false, text);
    }
    return runs;
  }

 private:
  /// What the recording shows is asked once, at the base: points are compared with each other. The
  /// noise is what is tuned.
  Settings completed(const std::string& log, const tuning::GridPoint& point) {
    const auto as_told = [&log](Settings settings) {
      settings.calibrate.noise = "off";
      return settings_for(log, settings);
    };
    const std::lock_guard<std::mutex> lock(mutex_);
    surveyor_.complete(log, as_told(job_.base));
    return surveyor_.complete(log, as_told(job_.at(point)));
  }

  const TuneJob& job_;
  RunStore& store_;
  std::mutex mutex_;
  Surveyor surveyor_;
  std::shared_ptr<SharedLogs> logs_ = std::make_shared<SharedLogs>();
  std::map<std::string, std::string> contents_;
};

tuning::SearchPlan plan(const TuneJob& job, RunStore& store, Console& console) {
  const auto maker = std::make_shared<PointMaker>(job, store, console);
  const auto runs = [maker](const std::string& log, const std::string& method,
                            const tuning::GridPoint& point) {
    return maker->runs(log, method, point);
  };
  return {job.config, job.logs, job.base.outages.shifts_s.size(), runs,
          [&console](const std::string& method) { return console.progress_of(method); }};
}

std::size_t runs_of(const std::vector<tuning::MethodTuning>& tunings,
                    const tuning::SearchPlan& plan) {
  std::size_t points = 0;
  for (const tuning::MethodTuning& tuning : tunings) points += tuning.scores.size();
  return points * plan.logs.size() * plan.shifts;
}

}  // namespace

Settings TuneJob::at(const tuning::GridPoint& point) const {
  Settings settings = base;
  for (const std::string& assignment : config.assignments(point)) set_config(assignment, settings);
  return settings;
}

void load_grid(const std::string& path, const std::vector<std::string>& assignments, TuneJob& job) {
  job.config = tuning::load_tune_config(path, assignments, tunable(job.base));
}

void load_grid_text(const std::string& yaml, const std::string& origin,
                    const std::vector<std::string>& assignments, TuneJob& job) {
  job.config = tuning::load_tune_config_text(yaml, origin, assignments, tunable(job.base));
}

std::vector<tuning::MethodTuning> search(const TuneJob& job, RunStore& store, Console& console) {
  check(job);
  const tuning::SearchPlan search_plan = plan(job, store, console);
  std::vector<tuning::MethodTuning> tunings;
  for (const std::string& method : job.config.methods) {
    tunings.push_back(tuning::search(search_plan, method, store.runs()));
  }
  store.report(runs_of(tunings, search_plan), console);
  return tunings;
}

std::vector<std::string> tune(const TuneJob& job, RunStore& store, Console& console) {
  if (store.is_worker()) {
    search(job, store, console);
    return {};
  }
  OutputDirectory directory(job.out);
  const tuning::TuningResult result{job.config, search(job, store, console), base_text(job),
                                    kVersion};
  const auto config_at = [&job](const tuning::GridPoint& point) {
    Settings settings = job.at(point);
    return dump_config(settings);
  };
  tuning::write_tuning(result, config_at, directory.staging());
  if (job.report) {
    console.progress("drawing", 0);
    page::write_report(tuning_page(result, job.logs.size(), job.command_line),
                       (directory.staging() / "report").string());
  }
  directory.commit();
  std::vector<std::string> lines = tuning::tuning_lines(result, job.out);
  for (const std::string& line : written_lines(job.out, job.report)) lines.push_back(line);
  return lines;
}

}  // namespace foucault::app
