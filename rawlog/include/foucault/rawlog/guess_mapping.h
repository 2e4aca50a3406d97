#pragma once

#include <map>
#include <string>
#include <vector>

#include "foucault/rawlog/import_mapping.h"

/// A mapping to start from, guessed from tables of which nothing is told: files, columns, units,
/// axes and clocks by the names that loggers use, and by what the data can only be: gravity is one
/// g, gyroscopes turn as the course does, accelerations along the track show what looks forward.
namespace foucault::rawlog {

struct MappingGuess {
  ImportMapping mapping;
  /// Beside a key, as `imu.axes`: what it is known by, or `not sure: why, what else it may be`.
  std::map<std::string, std::string> comments;
  std::vector<std::string> notes;  ///< of the whole
};

/// Files are named in the mapping relative to `folder`, where it is to lie.
/// Without positions there is no section `gnss`. Throws UsageError if no IMU is found, DataError if
/// a file is no table.
MappingGuess guess_mapping(const std::vector<std::string>& files, const std::string& folder);

/// As YAML with the comments; `load_config_text` of it gives the mapping.
std::string mapping_text(const MappingGuess& guess);

}  // namespace foucault::rawlog
