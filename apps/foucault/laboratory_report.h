#pragma once

#include "foucault/content/laboratory_report.h"
#include "laboratory_output.h"

namespace foucault::app {

/// The report of the preintegration laboratory as plain data.
content::LaboratoryReport laboratory_report(const LabResult& result);

}  // namespace foucault::app
