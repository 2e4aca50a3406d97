#pragma once

#include <string>
#include <vector>

#include "foucault/page/report_page.h"
#include "run_job.h"

/// The metrics of a run, for programs, for the console and for the report.
namespace foucault::app {

/// metrics.json; numbers that do not exist are null.
std::string metrics_json(const RunResult& result);

std::vector<std::string> metrics_lines(const RunResult& result);

/// Whether the run can be believed, and why.
std::string verdict_line(const RunResult& result);
page::Banner verdict_banner(const RunResult& result);

std::vector<page::KeyNumber> key_numbers(const RunResult& result);
std::vector<page::Table> metrics_tables(const RunResult& result);

}  // namespace foucault::app
