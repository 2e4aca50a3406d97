#include "jobs/tune_job.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "foucault/core/error.h"
#include "foucault/page/report_page.h"
#include "foucault/tuning/tuning_output.h"
#include "interrupt.h"
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
  return {base, try_on, [](const std::string& method) { find_method(method); }, method_names()};
}

std::string base_text(const TuneJob& job) {
  Settings base = job.base;
  return dump_config(base);
}

void make_folder(const std::string& out) {
  if (out.empty()) throw UsageError("--out is empty; name a folder for the results");
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) {
    throw DataError(
        fmt::format("cannot write to '{}': {}; give another --out", out, error.message()));
  }
}

void check(const TuneJob& job) {
  for (const EvaluationCase& c : cross(job.logs, job.config.methods, job.base)) experiment_runs(c);
  check_logs(job.logs, job.base);
}

tuning::SearchPlan plan(const TuneJob& job, Console& console) {
  const auto surveyor = std::make_shared<Surveyor>(console);
  const auto runs = [&job, surveyor](const std::string& log, const std::string& method,
                                     const tuning::GridPoint& point) {
    // What the recording shows is asked once, at the base: points are compared with each other. The
    // noise is what is tuned.
    const auto as_told = [&log](Settings settings) {
      settings.calibrate.noise = "off";
      return settings_for(log, settings);
    };
    surveyor->complete(log, as_told(job.base));
    const Settings settings = surveyor->complete(log, as_told(job.at(point)));
    return experiment_runs({log, log, settings.imu.preset, method, "", settings});
  };
  return {job.config,
          job.logs,
          job.base.outages.shifts_s.size(),
          runs,
          job.threads,
          [&console](const std::string& method) { return console.progress_of(method); }};
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

std::vector<tuning::MethodTuning> search(const TuneJob& job, Console& console) {
  check(job);
  make_folder(job.out);
  const tuning::SearchPlan search_plan = plan(job, console);
  const std::string path = (std::filesystem::path(job.out) / "points.csv").string();
  tuning::PointStore store = tuning::open_points(path, search_plan, base_text(job), kVersion);
  if (store.size() > 0) {
    console.say(fmt::format("{:<10} {} points are in {} already", "resumed", store.size(), path));
  }
  std::vector<tuning::MethodTuning> tunings;
  try {
    for (const std::string& method : job.config.methods) {
      tunings.push_back(tuning::search(search_plan, method, store));
    }
  } catch (const Interrupted&) {
    console.warn(fmt::format("{} finished points are kept in {}; the same command goes on there",
                             store.size(), path));
    throw;
  }
  if (!std::filesystem::exists(path)) {
    console.warn(fmt::format("{} was removed meanwhile; finished points are not kept", path));
  }
  return tunings;
}

std::vector<std::string> tune(const TuneJob& job, Console& console) {
  const tuning::TuningResult result{job.config, search(job, console), base_text(job), kVersion};
  OutputDirectory directory(job.out);
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
