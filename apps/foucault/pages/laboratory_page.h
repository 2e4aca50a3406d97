#pragma once

#include "foucault/laboratory/preintegration_output.h"
#include "foucault/reports/laboratory_report.h"

namespace foucault::app {

/// The report of the preintegration laboratory as plain data.
reports::LaboratoryReport laboratory_report(const laboratory::StudyResult& result);

}  // namespace foucault::app
