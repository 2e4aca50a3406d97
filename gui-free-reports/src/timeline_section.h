#pragma once

#include <string>

#include "foucault/reports/report_page.h"
#include "run_data.h"

namespace foucault::reports {

std::string verdict_name(FixVerdict verdict);

/// What went wrong when, in one line, as lanes over time and as a table; empty without data.
Section timeline_section(const RunData& data, const std::string& subtitle);

}  // namespace foucault::reports
