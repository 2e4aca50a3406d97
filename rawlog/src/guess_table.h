#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "guess_names.h"

/// Tables of which nothing is known yet, as numbers.
namespace foucault::rawlog {

enum class CellKind {
  number,
  calendar,     ///< date and time of day, as seconds since 1970
  time_of_day,  ///< hh:mm:ss, as seconds since midnight
  date,         ///< as seconds since 1970
  text
};

struct GuessColumn {
  std::string key;  ///< what a mapping calls it: its name, or its number from 1
  ColumnName name;
  CellKind kind = CellKind::number;
  std::vector<double> values;           ///< a row each; NaN: blank, or not of this kind
  double filled = 0;                    ///< part of the rows with a value
  std::map<std::string, size_t> texts;  ///< cells as they stand, if there are few different ones
};

struct GuessTable {
  std::string path;
  bool header = true;
  std::vector<GuessColumn> columns;
  size_t rows = 0;
  bool whole = true;  ///< else only the first rows were read

  std::optional<size_t> find(const std::string& role) const;  ///< the first column of this role
};

/// Rows of which columns are kept in memory: an hour at 100 Hz.
inline constexpr size_t kMostGuessRows = 400'000;

/// Finds separator, header and units under it in the data. Throws DataError if the file is no
/// table of numbers.
GuessTable read_guess_table(const std::string& path, size_t most_rows = kMostGuessRows);

}  // namespace foucault::rawlog
