#pragma once

#include <filesystem>
#include <string>

#include "foucault/export/solution_file.h"
#include "foucault/export/text_file.h"
#include "foucault/state/interfaces.h"

namespace foucault::exports {

/// An epoch in the units and axes of solution.csv: local NED of the vehicle's place, attitude of
/// the vehicle (forward-right-down).
std::string csv_row(const state::Epoch& epoch, const state::Mounting& mounting);
std::string csv_header();

class SolutionCsv : public SolutionFile {
 public:
  SolutionCsv(const std::filesystem::path& path, const state::Mounting& mounting);

  void epoch(const state::Epoch& epoch) override { file_.write(csv_row(epoch, mounting_)); }
  void finish() override { file_.close(); }

 private:
  state::Mounting mounting_;
  TextFile file_;
};

}  // namespace foucault::exports
