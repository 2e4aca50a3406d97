#pragma once

#include <string>
#include <vector>

#include "foucault/core/profile.h"
#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

/// What the run took: the time of each stage, the solver's iterations and time; no content where
/// nothing was timed.
page::Section processing_section(const RunData& data, const std::vector<StageTime>& stages,
                                 const std::string& subtitle);

}  // namespace foucault::content
