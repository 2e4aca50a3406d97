#include "foucault/export/solution_writer.h"

#include "foucault/export/solution_csv.h"
#include "foucault/export/solution_tum.h"
#include "foucault/export/track_kml.h"

namespace foucault::exports {

SolutionWriter::SolutionWriter(const std::filesystem::path& folder,
                               const state::Mounting& mounting) {
  files_.push_back(std::make_unique<SolutionCsv>(folder / "solution.csv", mounting));
  files_.push_back(std::make_unique<SolutionTum>(folder / "solution.tum", mounting));
  files_.push_back(std::make_unique<TrackKml>(folder / "solution.kml"));
}

void SolutionWriter::epoch(const state::Epoch& epoch) {
  for (const auto& file : files_) file->epoch(epoch);
}

void SolutionWriter::finish() {
  for (const auto& file : files_) file->finish();
}

}  // namespace foucault::exports
