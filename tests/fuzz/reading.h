#pragma once

#include <string>

namespace foucault::fuzz {

/// Reads a rawlog through with every reader we have, and checks what they promise: order of stamps
/// and values that are finite.
void read_rawlog(const std::string& path);

/// The same of a rawlog that we wrote: it must be whole.
void read_own_rawlog(const std::string& path);

}  // namespace foucault::fuzz
