#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"
#include "text_table.h"

/// Where a mapping's columns stand in its table, and what its times mean.
namespace foucault::rawlog {

/// Opens the table of a mapping; Columns finds out how it is to be read.
TextTable open_mapped_table(const std::string& path);

/// Where the roles of a mapping stand in the rows of its file.
class Columns {
 public:
  /// Reads what stands before the first row: other lines, the header if there is one (the first
  /// line that has all named columns), units under it. Finds the separator by it. `section` (imu,
  /// gnss, reference) is for messages.
  /// Throws UsageError for unknown roles and columns that are not there.
  Columns(const TableMapping& mapping, TextTable& table, const std::string& section,
          const std::vector<std::string>& roles);

  bool has(const std::string& role) const { return index_.count(role) > 0; }
  bool has_all(const std::vector<std::string>& roles) const;
  /// Throws UsageError if the mapping does not name the role; `instead` is what else may be done.
  size_t of(const std::string& role, const std::string& instead = {}) const;
  std::optional<size_t> find(const std::string& role) const;
  /// Throws RowError unless the row has as many columns as the header, or as the first row; those
  /// behind them may be empty.
  void check_width(const Row& row);
  const std::string& section() const { return section_; }

 private:
  void find_roles(const TableMapping& mapping, const std::vector<std::string>& header,
                  const std::string& path);
  bool has_units(std::string_view line, TextTable::Separator separator) const;

  std::string section_;
  std::map<std::string, size_t> index_;
  size_t width_ = 0;
};

/// The time column of a row, or its date and time, as a stamp, with the constant offset.
class TimeColumn {
 public:
  /// Throws UsageError if the mapping is incomplete.
  TimeColumn(const TimeMapping& mapping, const Columns& columns);

  /// Of one row after the other: times that begin again with their day or week go on.
  int64_t stamp(const Row& row);

 private:
  bool is_text(const Row& row) const;
  int64_t calendar(const Row& row) const;
  int64_t number(const Row& row);

  size_t time_;
  std::optional<size_t> date_;
  std::optional<size_t> week_column_;
  std::optional<RollingTime> rolling_;
  std::string system_;
  int decimals_ = 9;
  bool gps_ = true;
  int64_t week_ = 0;
  int64_t origin_ns_ = 0;  ///< of the time column, in the GPS week or on the UNIX scale
  int64_t offset_ns_ = 0;
};

}  // namespace foucault::rawlog
