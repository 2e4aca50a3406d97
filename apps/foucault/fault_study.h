#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "foucault/evaluation/drift_table.h"
#include "foucault/simulation/faults.h"
#include "foucault/simulation/scenario.h"
#include "settings.h"

/// What faults of recordings do to the methods, on simulated trips with exact truth.
namespace foucault::app {

struct FaultCase {
  std::string name;   ///< "fix_ramp"
  std::string title;  ///< what is injected, in words
  std::vector<Fault> faults;
};

/// All of them, the clean recording first.
const std::vector<FaultCase>& fault_cases();

/// Throws UsageError naming the known cases.
const FaultCase& find_fault_case(const std::string& name);

/// The trip, common to all cases: city, ADIS16465 at 200 Hz, RTK at 1 Hz, 460 s, of which the first
/// 40 at rest; faults of the middle begin at kFaultStart.
ScenarioOptions fault_scenario(int64_t seed);
constexpr double kFaultStart = 200;

struct FaultOutcome {
  std::string fault;
  std::string method;
  int64_t seed = 0;
  int exit_code = 0;     ///< the program's
  std::string message;   ///< the error, or what the notices say
  int64_t used = 0;      ///< fixes
  int64_t rejected = 0;  ///< fixes
  double rms_m = 0;      ///< horizontal error, from 60 s after the alignment on
  double largest_m = 0;  ///< its largest
  /// From the end of the fault (or its start, if it does not end) until the error stays below
  /// kRecovered; none if it does not before the end.
  std::optional<double> recovery_s;
};

/// Horizontal error that counts as recovered [m]: 10 sigmas of a fix.
constexpr double kRecovered = 0.1;

FaultOutcome run_fault(const FaultCase& fault, const std::string& method, const Settings& settings,
                       int64_t seed);

/// A row a case and method.
TextTable fault_table(const std::vector<FaultOutcome>& outcomes);

}  // namespace foucault::app
