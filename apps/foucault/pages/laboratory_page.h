#pragma once

#include "foucault/content/laboratory_report.h"
#include "foucault/laboratory/preintegration_output.h"

namespace foucault::app {

/// The report of the preintegration laboratory as plain data.
content::LaboratoryReport laboratory_report(const laboratory::StudyResult& result);

}  // namespace foucault::app
