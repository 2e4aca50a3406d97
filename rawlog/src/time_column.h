#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"
#include "table_columns.h"

/// What the times of a mapping's table mean.
namespace foucault::rawlog {

/// Roles of the columns that tell time.
const std::vector<std::string>& time_roles();

/// The time column of a row, or its date and time, as a stamp, with the constant offset.
class TimeColumn {
 public:
  /// Throws UsageError if the mapping is incomplete.
  TimeColumn(const TimeMapping& mapping, const Columns& columns);

  /// Of one row after the other: times that begin again with their day, their week or a counter of
  /// 32 bits go on.
  int64_t stamp(const Row& row);

 private:
  enum class Kind { number, hhmmss, days };

  void find_week(const TimeMapping& mapping, const Columns& columns);
  bool is_text(const Row& row) const;
  int64_t calendar(const Row& row) const;
  int64_t number(const Row& row);
  int64_t value(const Row& row) const;
  int64_t time_of_day(const Row& row) const;
  int64_t hours_minutes_seconds(const Row& row) const;
  int64_t day_number(const Row& row) const;
  int64_t plain_number(const Row& row) const;
  void check_range(const Row& row, int64_t time_ns) const;
  [[noreturn]] void out_of_range(const Row& row) const;
  int64_t week(const Row& row) const;

  std::string section_;
  size_t time_;
  std::optional<size_t> date_;
  std::optional<size_t> nanosecond_;
  std::optional<std::array<size_t, 3>> day_parts_;   ///< year, month, day
  std::optional<std::array<size_t, 3>> time_parts_;  ///< hour, minute, second
  std::optional<size_t> week_column_;
  std::optional<int64_t> add_weeks_;
  std::optional<RollingTime> rolling_;
  std::string system_;
  std::string date_format_;
  Kind kind_ = Kind::number;
  int decimals_ = 9;
  bool gps_ = true;
  bool first_ = true;
  int64_t week_ = 0;
  int64_t origin_ns_ = 0;  ///< of the time column, in the GPS week or on the UNIX scale
  int64_t offset_ns_ = 0;
};

/// Whether times told to be seconds of a day are hhmmss: no row has more than 59 in its seconds or
/// minutes, and they jump from there to the next hundred. Reads the whole table.
bool has_hhmmss(const TableMapping& mapping, const std::string& path, const std::string& section);

}  // namespace foucault::rawlog
