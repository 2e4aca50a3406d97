#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/simulation/faults.h"

/// Faults of recordings by name, for `simulate` and `lab faults`.
namespace foucault::laboratory {

/// What is done to a rawlog once it is written.
enum class FileDamage {
  none,
  truncated,    ///< the last 40 % are missing
  overwritten,  ///< 64 bytes in the middle are others
  emptied,
  text,  ///< a text in its place
};

struct FaultCase {
  std::string name;   ///< "ramp"
  std::string title;  ///< what is injected, in words
  std::vector<simulation::Fault> faults;
  FileDamage damage = FileDamage::none;
  std::optional<double>
      sigma_m{};  ///< of the fixes, horizontal and twice that down; else the trip's
};

/// All of them, the clean recording first. Those of the middle begin at kFaultStart.
const std::vector<FaultCase>& fault_cases();
constexpr double kFaultStart = 200;  // [s]

/// Throws UsageError naming the known cases.
const FaultCase& find_fault_case(const std::string& name);

/// Throws DataError if the file cannot be changed.
void damage_file(const std::string& path, FileDamage damage);

}  // namespace foucault::laboratory
