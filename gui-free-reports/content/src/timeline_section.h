#pragma once

#include <string>

#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

std::string verdict_name(state::FixVerdict verdict);

/// What went wrong when, in one line, as lanes over time and as a table; empty without data.
page::Section timeline_section(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
