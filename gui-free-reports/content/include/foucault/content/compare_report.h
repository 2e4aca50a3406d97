#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/page/report_page.h"

/// Solutions of the same time beside each other.
namespace foucault::content {

struct ComparedEpoch {
  int64_t t_ns = 0;
  Geodetic position;
  double roll_deg = 0, pitch_deg = 0, heading_deg = 0;
  double sigma_north_m = 0, sigma_east_m = 0, sigma_down_m = 0;
};

struct ComparedRun {
  std::string name;                                             ///< for readers; each another one
  std::string method;                                           ///< of the program, or empty
  std::vector<ComparedEpoch> epochs;                            ///< in order of stamps
  std::vector<std::pair<std::string, std::string>> facts = {};  ///< a word and a number for a table
};

/// Tracks together, differences from the first run with their statistics by axis, sigmas. At least
/// two runs; differences are where both have epochs at most 5 s apart on both sides.
page::ReportPage compare_page(const std::vector<ComparedRun>& runs, const std::string& footer);

}  // namespace foucault::content
