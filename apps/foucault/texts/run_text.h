#pragma once

#include <optional>
#include <string>
#include <vector>

#include "jobs/run_job.h"

/// The metrics of a run, for programs and for the console.
namespace foucault::app {

/// metrics.json
std::string metrics_json(const RunResult& result);

std::vector<std::string> metrics_lines(const RunResult& result);

/// How far smoothed and forward run lie apart.
std::string separation_text(const evaluation::SeparationMetrics& separation);

/// Whether the run can be believed, and why.
std::string verdict_line(const RunResult& result);

/// What speaks against a run that the fixes speak for: errors against the reference are larger than
/// its sigmas say. None if they are not, or without a reference.
std::optional<std::string> against_reference(const RunResult& result);

/// What speaks for a run.
std::string size_text(const RunResult& result);

}  // namespace foucault::app
