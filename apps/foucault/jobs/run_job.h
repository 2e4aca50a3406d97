#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/core/profile.h"
#include "foucault/evaluation/run_metrics.h"
#include "foucault/page/report_page.h"
#include "jobs/forward_run.h"
#include "jobs/run_facts.h"
#include "methods.h"
#include "resources.h"
#include "settings.h"

namespace foucault::app {

/// One log, one method.
struct RunJob {
  std::string log;
  std::string method = kDefaultMethod;
  Settings settings;
  std::string out;       ///< folder
  bool report = true;    ///< draw the figures
  bool profile = false;  ///< time the stages
  std::string command_line;
  std::vector<page::Link> links = {};  ///< pages beside the report
};

struct RunResult {
  std::string method;
  std::string log;
  std::string out;
  bool report = true;
  evaluation::RunMetrics metrics;
  std::optional<ForwardResult> forward;  ///< of a smoother
  std::vector<evaluation::CalibratedBlock> calibration;
  std::vector<evaluation::CalibratedBlock> told;  ///< the same before anything was measured
  double statistics_from_s = 0;
  RunFacts facts;
  std::string command_line;
  std::string noise;               ///< of the IMU: its preset, or the numbers in force
  Resources resources;             ///< of reading and estimating, without the report
  std::vector<StageTime> profile;  ///< of everything, if asked for
  /// Why the log broke off, one line; the results are up to there.
  std::optional<std::string> damage;
};

/// Processes the log and writes solution.csv, .tum, .kml, metrics.json, config.yaml and report/ to
/// job.out: all of it or, if something goes wrong, nothing. A log that breaks off gives results up
/// to there. Throws DataError, UsageError, Interrupted.
RunResult run(const RunJob& job, Console& console);

/// The same into a folder that exists, with no care for what is in it.
RunResult run_into(const RunJob& job, const std::filesystem::path& folder, Console& console);

/// What a user wants to know first; the verdict last.
std::vector<std::string> summary_lines(const RunResult& result);

}  // namespace foucault::app
