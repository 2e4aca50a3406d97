#pragma once

#include <string>

#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

/// The blocks that were estimated: at the end, over time, and which of them the recording does not
/// tell. Empty without blocks. `subtitle` names the run.
page::Section calibration_section(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
