#pragma once

#include "foucault/rawlog/import_raw_gnss.h"
#include "import_run.h"

namespace foucault::rawlog {

/// Fixes that RTKLIB makes of a receiver's raw observations, merged with the other inputs.
/// `mapping` tells what to take of them.
ImportSummary import_raw_observations(const RawGnssImport& options, ImportInputs inputs,
                                      const ImportMapping& mapping);

}  // namespace foucault::rawlog
