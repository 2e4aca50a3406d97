#pragma once

#include <string>
#include <vector>

#include "foucault/content/run_report.h"
#include "run_data.h"

namespace foucault::content {

/// What was measured beside positions, and how it fits. Empty without aids. `subtitle` names the
/// run.
page::Section aids_section(const RunData& data, const std::vector<AidSummary>& aids,
                           const std::string& subtitle);

}  // namespace foucault::content
