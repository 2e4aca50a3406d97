#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "foucault/export/solution_file.h"
#include "foucault/state/interfaces.h"

namespace foucault::exports {

/// Streams the solution into solution.csv, solution.tum and solution.kml of a folder. Throws
/// WriteError if they cannot be written.
class SolutionWriter : public state::Sink {
 public:
  SolutionWriter(const std::filesystem::path& folder, const state::Mounting& mounting);

  void epoch(const state::Epoch& epoch) override;

  /// Completes the files.
  void finish();

 private:
  std::vector<std::unique_ptr<SolutionFile>> files_;
};

}  // namespace foucault::exports
