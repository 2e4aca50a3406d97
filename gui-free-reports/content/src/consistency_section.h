#pragma once

#include <string>

#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

/// NIS, whitened innovations and NEES with what they should be; empty if there are none.
page::Section consistency_section(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
