#pragma once

#include <memory>
#include <string>

#include "import_run.h"

namespace foucault::rawlog {

/// Fixes of a .pos file of RTKLIB, see RtklibImport. Throws DataError and UsageError.
std::unique_ptr<RecordReader> make_pos_reader(const GnssMapping& mapping, const std::string& path);

}  // namespace foucault::rawlog
