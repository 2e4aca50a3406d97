#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import_mapping.h"
#include "guess_table.h"

/// Which columns are the time of a table, and of which clock.
namespace foucault::rawlog {

/// A guess, as the comment beside it says it.
struct Remark {
  bool sure = true;
  std::string text;

  std::string comment() const { return sure ? text : "not sure: " + text; }
};

enum class ClockKind { absolute, week_seconds, day_seconds, relative };

/// One way to read the time of a table.
struct ClockGuess {
  ClockKind kind = ClockKind::relative;
  TimeMapping mapping;
  std::map<std::string, std::string> columns;  ///< time, date, week
  Remark remark;
  std::vector<double> t;  ///< a row each [s], of UTC if absolute; NaN without
  double score = 0;       ///< of names and regularity
};

/// Steps that samples of such a table may have [s].
struct StepRange {
  double shortest, longest;
};
inline constexpr StepRange kImuSteps{2e-4, 0.2};
inline constexpr StepRange kFixSteps{0.02, 30};

/// All columns that may be the time of rows in which `present` is true, best name first. `first` is
/// the first word of the names of the sensor's columns.
std::vector<ClockGuess> clocks_of(const GuessTable& table, const std::vector<bool>& present,
                                  StepRange steps, const std::string& first);

/// Clocks of two tables that go together: `mapping`s complete where the files tell enough.
struct ClockPair {
  ClockGuess imu, gnss;
  bool overlap = false;
};
std::optional<ClockPair> paired_clocks(const std::vector<ClockGuess>& imu,
                                       const std::vector<ClockGuess>& gnss);

}  // namespace foucault::rawlog
