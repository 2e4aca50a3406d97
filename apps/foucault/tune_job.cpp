#include "tune_job.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <system_error>

#include "evaluation_job.h"
#include "foucault/core/error.h"
#include "foucault/evaluation/point_store.h"
#include "foucault/page/report_page.h"
#include "interrupt.h"
#include "output_directory.h"
#include "point_scorer.h"
#include "tune_output.h"
#include "version.h"

namespace foucault::app {
namespace {

std::string grid_text(const ParameterGrid& grid) {
  std::string text;
  for (const GridAxis& axis : grid.axes) {
    text += axis.key + "\n";
    for (const std::string& value : axis.values) text += "  " + value + "\n";
  }
  return text;
}

/// What the scores of points depend on. Objective and way of searching are none of it: with others
/// the finished points stay of use.
std::vector<Fingerprint> fingerprints(const TuneJob& job) {
  std::string logs;
  for (const std::string& log : job.logs) logs += hash_file(log);
  Settings base = job.config.base;
  return {{"logs", hash_text(logs)},
          {"base configuration", hash_text(dump_config(base))},
          {"grid", hash_text(grid_text(job.config.grid))},
          {"program version", kVersion}};
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

MethodTuning search_method(const TuneJob& job, const std::string& method, PointScorer& scorer) {
  MethodTuning tuning;
  tuning.method = method;
  const BatchObjective objective = [&](const std::vector<GridPoint>& points) {
    const std::vector<PointScore> scores = scorer.scores(method, points);
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); ++i) {
      tuning.scores[points[i]] = scores[i];
      values.push_back(
          job.config.options.objective_of(scores[i].horizontal_rms, scores[i].vertical_rms));
    }
    return values;
  };
  const ParameterGrid& grid = job.config.grid;
  tuning.search = job.config.options.search == "full" ? full_search(grid, objective)
                                                      : coarse_to_fine_search(grid, objective);
  if (!std::isfinite(tuning.search.value)) {
    throw DataError(fmt::format("{}: no point of the grid gave a drift; the first: {}", method,
                                tuning.scores.begin()->second.note));
  }
  return tuning;
}

void check(const TuneJob& job) {
  for (const std::string& method : job.config.options.methods_to_tune()) {
    const std::vector<EvaluationCase> cases = cross(job.logs, {method}, job.config.base);
    for (const EvaluationCase& c : cases) experiment_runs(c);
  }
  check_logs(job.logs, job.config.base);
}

}  // namespace

std::vector<MethodTuning> search(const TuneJob& job, Console& console) {
  check(job);
  make_folder(job.out);
  const ParameterGrid& grid = job.config.grid;
  const std::string path = (std::filesystem::path(job.out) / "points.csv").string();
  PointStore store(path, fingerprints(job), PointScorer::header(grid),
                   PointScorer::key_columns(grid));
  if (store.size() > 0) {
    console.say(fmt::format("{:<10} {} points are in {} already", "resumed", store.size(), path));
  }
  PointScorer scorer(job, store, console);
  std::vector<MethodTuning> tunings;
  try {
    for (const std::string& method : job.config.options.methods_to_tune()) {
      tunings.push_back(search_method(job, method, scorer));
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
  const std::vector<MethodTuning> tunings = search(job, console);
  OutputDirectory directory(job.out);
  write_tuning(job, tunings, directory.staging());
  if (job.report) {
    console.progress("drawing", 0);
    page::write_report(tuning_page(job, tunings), (directory.staging() / "report").string());
  }
  directory.commit();
  std::vector<std::string> lines = tuning_lines(job, tunings);
  lines.push_back(fmt::format("{:<10} {}", "written", job.out));
  if (job.report) {
    const std::filesystem::path page = std::filesystem::path(job.out) / "report" / "index.html";
    lines.push_back(fmt::format("{:<10} {}", "report", page.string()));
  }
  return lines;
}

}  // namespace foucault::app
