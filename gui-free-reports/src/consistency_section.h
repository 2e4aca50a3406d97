#pragma once

#include <string>

#include "foucault/reports/report_page.h"
#include "run_data.h"

namespace foucault::reports {

/// NIS, whitened innovations and NEES with what they should be; empty if there are none.
Section consistency_section(const RunData& data, const std::string& subtitle);

}  // namespace foucault::reports
