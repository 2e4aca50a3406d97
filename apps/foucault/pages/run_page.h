#pragma once

#include <vector>

#include "foucault/page/report_page.h"
#include "jobs/run_job.h"

/// The metrics of a run, for its report.
namespace foucault::app {

page::Banner verdict_banner(const RunResult& result);
std::vector<page::KeyNumber> key_numbers(const RunResult& result);
/// What a surveyor reads first, then the statistics.
std::vector<page::Table> metrics_tables(const RunResult& result);

}  // namespace foucault::app
