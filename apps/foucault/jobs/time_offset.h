#pragma once

#include <string>

#include "console.h"
#include "settings.h"

namespace foucault::app {

/// Settings in which calibrate.time_offset_s is what a filter finds in the log, where the block is
/// estimated: an estimate is of the first order, so that fixes are moved by it and it is made
/// again, until what is left is small. What the filter cannot process changes nothing.
Settings with_time_offset(const std::string& log, const Settings& settings, Console& console);

}  // namespace foucault::app
