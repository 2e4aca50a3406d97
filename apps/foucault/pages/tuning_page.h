#pragma once

#include <cstddef>
#include <string>

#include "foucault/page/report_page.h"
#include "foucault/tuning/tuning_output.h"

namespace foucault::app {

/// A map for each pair of parameters in order, a curve for a parameter by itself.
page::ReportPage tuning_page(const tuning::TuningResult& result, std::size_t recordings,
                             const std::string& command_line);

}  // namespace foucault::app
