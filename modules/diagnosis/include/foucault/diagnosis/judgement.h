#pragma once

#include <string>
#include <vector>

#include "foucault/diagnosis/log_facts.h"
#include "foucault/imu/imu_noise.h"

namespace foucault::diagnosis {

enum class Severity { ok, warning, error };

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  ///< "time offset"
  std::string text;     ///< what was found, one line with numbers
  std::string remedy;   ///< what to do; empty if all is well
};

/// Subjects of samples and fixes that were left out, a line a kind.
inline constexpr const char* kSamplesSubject = "IMU samples";
inline constexpr const char* kFixesSubject = "GNSS fixes";

/// Everything that was looked at, also what is well. Each fact that is printed is judged.
std::vector<Finding> judge(const LogFacts& facts, const imu::ImuNoise& configured);

}  // namespace foucault::diagnosis
