#pragma once

#include <string>
#include <vector>

#include "foucault/laboratory/fault_study.h"
#include "foucault/laboratory/return_study.h"
#include "foucault/laboratory/start_study.h"
#include "settings.h"

/// The laboratory's studies with this program's recordings and methods.
namespace foucault::app {

/// Writes the trip with its fault to `log`, processes it with each method as `foucault run` does,
/// and removes it.
std::vector<laboratory::FaultOutcome> run_fault(const laboratory::FaultCase& fault,
                                                const std::vector<std::string>& methods,
                                                const Settings& settings, int64_t seed,
                                                const std::string& log);

laboratory::ReturnOutcome study_return(const laboratory::ReturnCase& what,
                                       const Settings& settings);

/// By the filter, with the velocities of the fixes: the drive that follows is not the matter.
laboratory::StartOutcome study_start(int64_t seed, const Settings& settings);

}  // namespace foucault::app
