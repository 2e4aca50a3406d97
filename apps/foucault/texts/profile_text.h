#pragma once

#include <string>
#include <vector>

#include "foucault/core/profile.h"

/// A profile for the console.
namespace foucault::app {

double total_seconds(const std::vector<StageTime>& profile);

/// A line a stage, and their sum; none without a profile.
std::vector<std::string> profile_lines(const std::vector<StageTime>& profile);

}  // namespace foucault::app
