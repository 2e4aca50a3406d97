#pragma once

#include <string>
#include <vector>

#include "console.h"

namespace foucault::app {

/// Writes `out`/report with the runs in the folders together. Throws DataError, UsageError.
void compare(const std::vector<std::string>& folders, const std::string& out, Console& console);

}  // namespace foucault::app
