#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fault_cases.h"
#include "foucault/core/consistency.h"
#include "foucault/evaluation/drift_table.h"
#include "foucault/simulation/scenario.h"
#include "settings.h"

/// What faults of recordings do to the methods, on simulated trips with exact truth.
namespace foucault::app {

/// The trip, common to all cases: city, ADIS16465 at 200 Hz, RTK at 1 Hz, 460 s, of which the first
/// 40 at rest.
ScenarioOptions fault_scenario(int64_t seed);

struct FaultOutcome {
  std::string fault;
  std::string method;
  int64_t seed = 0;
  int exit_code = 0;           ///< the program's
  std::string message;         ///< the error, or what the notices say
  int64_t used = 0;            ///< fixes
  int64_t rejected = 0;        ///< fixes
  std::optional<Trust> trust;  ///< none if nothing came out
  int64_t errors = 0;          ///< epochs compared with the truth
  double rms_m = 0;            ///< horizontal error, from 60 s after the alignment on
  double largest_m = 0;        ///< its largest
  /// From the end of the fault (or its start, if it does not end) until the error stays below
  /// kRecoveredSigmas of a fix; none if it does not before the end, or nothing came out.
  std::optional<double> recovery_s;
};

constexpr double kRecoveredSigmas = 10;

/// Writes the trip with its fault to `log`, processes it with each method as `foucault run` does,
/// and removes it.
std::vector<FaultOutcome> run_fault(const FaultCase& fault, const std::vector<std::string>& methods,
                                    const Settings& settings, int64_t seed, const std::string& log);

/// A row a case, method and seed.
TextTable fault_table(const std::vector<FaultOutcome>& outcomes);

/// A row a case, methods side by side, of the first seed.
TextTable fault_summary(const std::vector<FaultOutcome>& outcomes);

}  // namespace foucault::app
