#pragma once

#include "foucault/reports/laboratory_report.h"
#include "laboratory_output.h"

namespace foucault::app {

/// The report of the preintegration laboratory as plain data.
reports::LaboratoryReport laboratory_report(const LabResult& result);

}  // namespace foucault::app
