#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "foucault/evaluation/drift_table.h"
#include "foucault/laboratory/preintegration_study.h"

/// What the preintegration laboratory writes and says.
namespace foucault::laboratory {

/// Motions that were studied by one plan.
struct StudyResult {
  StudyPlan plan;
  std::vector<MotionStudy> motions;
  std::string command_line;
  std::string version;
};

/// Durations that tables and dot figures show [s]: two of the plan's, the paper's interval between
/// fixes and its outage.
std::vector<double> shown_durations_s();

/// Position errors of the models at the plan's rate, a row a motion and duration.
evaluation::TextTable model_table(const StudyResult& result);
/// Position, velocity and attitude errors of `full` over the plan's fine duration beside the
/// increments' discretization, a row a motion and rate.
evaluation::TextTable discretization_table(const StudyResult& result);
/// Position error without a term, in sigmas of each IMU's noise, after the shown durations.
evaluation::TextTable term_table(const StudyResult& result, const MotionStudy& motion);

/// preintegration.csv (a row a motion, group, name, rate, duration and distance), metrics.json.
void write_laboratory(const StudyResult& result, const std::filesystem::path& folder);

/// For the terminal.
std::vector<std::string> laboratory_lines(const StudyResult& result);

}  // namespace foucault::laboratory
