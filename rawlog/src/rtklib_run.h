#pragma once

#include <functional>
#include <string>
#include <vector>

#include "foucault/rawlog/import_raw_gnss.h"

namespace foucault::rawlog {

/// A folder that lives as long as this object.
class ScratchFolder {
 public:
  /// Throws DataError if there is no room for temporary files.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// What RTKLIB's programs make of a receiver's raw observations.
struct RtklibSolution {
  std::string pos;                   ///< the .pos file, in the folder
  std::vector<std::string> notices;  ///< what was assumed, a line each
};

/// `progress` gets the part done, 0 to 1, often, and may throw. Throws DataError and UsageError.
RtklibSolution solve_with_rtklib(const RawGnssImport& options, const ScratchFolder& folder,
                                 const std::function<void(double)>& progress);

}  // namespace foucault::rawlog
