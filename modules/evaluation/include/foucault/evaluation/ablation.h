#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/evaluation/statistics.h"
#include "foucault/evaluation/summary.h"

/// What parts of a configuration are worth: the same outages with them and without.
namespace foucault::evaluation {

struct AblationCase {
  std::string method;
  std::string without;  ///< what is off; empty: nothing, the configuration as it is

  /// Its name among methods.
  std::string label() const;
};

/// RMS over the outages of the largest drift in each.
struct AblationRow {
  AblationCase what;
  double horizontal_rms_m = 0;
  double vertical_rms_m = 0;
  /// (this - as it is) / as it is, on the same outages; none where nothing is off, or where the
  /// method failed as it is.
  std::optional<Estimate> horizontal_relative, vertical_relative;
};

/// In the order of `cases`; `outages` are of one group. Cases that failed are left out, and parts
/// that no recording has a use for: without them every outage is the same.
std::vector<AblationRow> ablation_rows(const std::vector<MethodOutages>& outages,
                                       const std::vector<AblationCase>& cases);

TextTable ablation_table(const std::vector<AblationRow>& rows);

/// The table and what it rests on, for the terminal.
std::vector<std::string> ablation_lines(const EvaluationSummary& summary,
                                        const std::vector<AblationCase>& cases);

}  // namespace foucault::evaluation
