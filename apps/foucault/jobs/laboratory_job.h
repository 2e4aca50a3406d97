#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/laboratory/fault_study.h"
#include "foucault/laboratory/return_study.h"
#include "foucault/laboratory/start_study.h"
#include "jobs/run_store.h"
#include "settings.h"

/// The laboratory's studies with this program's recordings and methods.
namespace foucault::app {

/// Writes the trip with its fault to `log`, processes it with each method as `foucault run` does,
/// and removes it.
std::vector<laboratory::FaultOutcome> run_fault(const laboratory::FaultCase& fault,
                                                const std::vector<std::string>& methods,
                                                const Settings& settings, int64_t seed,
                                                const std::string& log);

/// Each fault on the trip of each seed, by each method.
struct FaultStudy {
  std::vector<std::string> faults;
  std::vector<std::string> methods;
  std::vector<int64_t> seeds;
};

/// In the order of faults, seeds, methods. A trip with its fault is written into `folder`,
/// processed with each method as `foucault run` does, and removed. A worker has no outcomes: its
/// share of them is in the store. Throws UsageError, StoreError.
std::vector<laboratory::FaultOutcome> study_faults(const FaultStudy& study, RunStore& store,
                                                   const std::filesystem::path& folder,
                                                   Console& console);

laboratory::ReturnOutcome study_return(const laboratory::ReturnCase& what,
                                       const Settings& settings);

/// By the filter, with the velocities of the fixes: the drive that follows is not the matter.
laboratory::StartOutcome study_start(int64_t seed, const Settings& settings);

}  // namespace foucault::app
