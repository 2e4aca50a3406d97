#pragma once

#include "foucault/page/report_page.h"
#include "run_data.h"

namespace foucault::content {

/// Figures that readers of this field expect and that this page lacks, each with why.
page::Table missing_figures(const page::ReportPage& page, const RunData& data);

}  // namespace foucault::content
