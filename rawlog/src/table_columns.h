#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import_mapping.h"
#include "text_table.h"

/// Where a mapping's columns stand in its table.
namespace foucault::rawlog {

/// Opens the table of a mapping; Columns finds out how it is to be read.
TextTable open_mapped_table(const std::string& path);

/// Where the roles of a mapping stand in the rows of its file.
class Columns {
 public:
  /// Reads what stands before the first row: other lines, the header if there is one (the first
  /// line that has all named columns), units under it. Finds the separator by them and by the rows,
  /// whose width counts where the header has another. `section` (imu, gnss, reference, wheel) is
  /// for messages. Throws UsageError for unknown roles, columns that are not there or stand there
  /// twice, and commas that may be decimal or between thousands.
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
  /// What the table may mean otherwise.
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  void check_roles(const TableMapping& mapping, const std::vector<std::string>& roles) const;
  void find_roles(const TableMapping& mapping, const std::vector<std::string>& header,
                  const std::string& path);
  size_t find_column(const std::string& key, const std::string& name,
                     const std::vector<std::string>& header, const std::string& path) const;
  bool has_units(std::string_view line, TextTable::Separator separator) const;
  void check_commas(const std::vector<std::vector<std::string_view>>& rows,
                    const std::string& path) const;
  void look_for_sensors(const std::vector<std::string>& header,
                        const std::vector<std::vector<std::string_view>>& rows,
                        const std::string& path);

  std::string section_;
  std::map<std::string, size_t> index_;
  size_t width_ = 0;  ///< 0: as the first row
  std::vector<std::string> notices_;
};

}  // namespace foucault::rawlog
