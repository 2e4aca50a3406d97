#pragma once

#include <vector>

#include "foucault/reports/report_page.h"
#include "jobs/run_job.h"

/// The metrics of a run, for its report.
namespace foucault::app {

reports::Banner verdict_banner(const RunResult& result);
std::vector<reports::KeyNumber> key_numbers(const RunResult& result);
std::vector<reports::Table> metrics_tables(const RunResult& result);

}  // namespace foucault::app
