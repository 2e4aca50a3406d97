#pragma once

#include <string>
#include <vector>

#include "console.h"
#include "foucault/calibration/learn.h"
#include "jobs/allan_job.h"
#include "settings.h"

namespace foucault::app {

/// Noise from recordings of one vehicle.
struct LearnJob {
  std::vector<std::string> logs;
  Settings settings;
  std::string out;
  bool report = true;
  std::string command_line;
};

/// One learned number as people know it: the key that takes it, in its unit.
struct LearnedValue {
  std::string name, key, unit;
  double told = 0, value = 0;
  double factor = 1;  ///< one sigma of the value, by which it may be larger or smaller
  bool observable = true;
  std::vector<double> profile_factors, profile;
};

struct LearnResult {
  std::vector<std::string> logs;
  double length_s = 0;
  std::vector<LearnedValue> values;
  /// Errors of fixes that last: sigma in those of the fixes and correlation time; none if the
  /// recordings do not show them.
  std::optional<calibration::LastingErrors> lasting;
  std::vector<calibration::NormalizedError> before, after;
  int passes = 0;
  std::optional<AllanResult> rest;  ///< of the log that rests longest, ten minutes and more
  std::string out, command_line, config;
};

/// Learns the noise and writes learned.yaml (for `run --config`), metrics.json and report/.
/// Throws DataError if a log cannot be processed or is too short.
LearnResult learn(const LearnJob& job, Console& console);

std::vector<std::string> summary_lines(const LearnResult& result);

}  // namespace foucault::app
