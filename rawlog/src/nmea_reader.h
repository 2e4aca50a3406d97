#pragma once

#include <memory>
#include <optional>
#include <string>

#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"

namespace foucault::rawlog {

/// A file of NMEA and what is not in it.
struct NmeaFile {
  std::string path;
  std::string named;                 ///< in messages
  std::optional<int64_t> begins_ns;  ///< about when, for one that has no date
};

/// Fixes of sentences of NMEA. Throws DataError and UsageError as import_nmea().
std::unique_ptr<RecordReader> make_nmea_reader(const GnssMapping& mapping, const NmeaFile& file);

}  // namespace foucault::rawlog
