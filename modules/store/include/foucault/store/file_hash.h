#pragma once

#include <string>

#include "foucault/store/key.h"

namespace foucault::store {

/// What tells a version of a file from another without reading it: absolute path, size, time of
/// change to the nanosecond. Throws DataError if it is not there.
std::string file_stamp(const std::string& path);

/// SHA-256 of the content. Waits for a file that has just been written to be older than the
/// resolution of times of change, so that its stamp tells what changes later. Throws DataError if
/// it cannot be read, or changes meanwhile.
Key hash_file(const std::string& path);

}  // namespace foucault::store
