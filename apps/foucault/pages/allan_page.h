#pragma once

#include <vector>

#include "foucault/page/report_page.h"
#include "jobs/allan_job.h"

namespace foucault::app {

/// Of the gyroscopes and of the accelerometers.
std::vector<plot::Figure> allan_figures(const AllanResult& result);

/// Allan deviations with their fits beside the presets, and spectra at rest and in motion.
page::ReportPage allan_page(const AllanResult& result);

}  // namespace foucault::app
