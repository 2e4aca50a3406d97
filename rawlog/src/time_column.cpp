#include "time_column.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "calendar_text.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::rawlog {

namespace {

constexpr int kDecimalsOfDays = 12;

template <class Value>
Value needed(const std::optional<Value>& value, const std::string& section, const char* key,
             const std::string& system) {
  if (value) return *value;
  throw UsageError(
      fmt::format("{}.time.{} is missing; time system '{}' needs it", section, key, system));
}

void check_format(const std::string& format, const std::string& section) {
  if (format.empty() || is_date_format(format)) return;
  throw UsageError(fmt::format(
      "{}.time.date_format: '{}' is no format of a date; write it with strptime's letters, such as "
      "\"%d/%m/%Y\"; the time of day behind it is found",
      section, format));
}

/// Midnight, UTC.
int64_t parse_date(const std::string& date, const std::string& section) {
  if (const std::optional<int64_t> midnight = date_ns(date)) return *midnight;
  throw UsageError(fmt::format("{}.time.date: '{}' is no date; write YYYY-MM-DD", section, date));
}

/// Numbers that a clock of this system shows [ns].
struct TimeRange {
  int64_t first_ns, last_ns;
  const char* what;
};

TimeRange range_of(const std::string& system) {
  const int64_t since_1980 = kGpsEpochNs;
  constexpr int64_t kYears170 = 62'093 * kNanosecondsPerDay;
  if (system == "unix") return {since_1980, since_1980 + kYears170, "of the years 1980 to 2150"};
  if (system == "gps") return {0, kYears170, "of the years 1980 to 2150"};
  if (system == "seconds_of_day") return {-kNanosecondsPerDay, 8 * kNanosecondsPerDay, "of a day"};
  if (system == "boot")
    return {-1'000'000'000 * kNanosecondsPerSecond, 1'000'000'000 * kNanosecondsPerSecond,
            "since power-up"};
  return {-kNanosecondsPerWeek, 8 * kNanosecondsPerWeek, "of a week"};
}

}  // namespace

const std::vector<std::string>& time_roles() {
  static const std::vector<std::string> kRoles{"time",  "date", "week", "nanosecond", "year",
                                               "month", "day",  "hour", "minute",     "second"};
  return kRoles;
}

TimeColumn::TimeColumn(const TimeMapping& mapping, const Columns& columns)
    : section_(columns.section()),
      time_(columns.of(columns.has("hour") ? "second" : "time")),
      date_(columns.find("date")),
      nanosecond_(columns.find("nanosecond")),
      system_(mapping.system),
      date_format_(mapping.date_format),
      offset_ns_(nanoseconds(mapping.offset_s)) {
  check_format(date_format_, section_);
  if (columns.has("hour")) time_parts_ = {columns.of("hour"), columns.of("minute"), time_};
  if (columns.has("year")) {
    day_parts_ = {columns.of("year"), columns.of("month"), columns.of("day")};
  }
  const bool of_day = system_ == "seconds_of_day";
  if ((time_parts_ && !of_day && system_ != "iso8601") || (day_parts_ && system_ != "iso8601")) {
    throw UsageError(fmt::format(
        "{}.columns: year, month, day, hour, minute, second need {}.time.system: iso8601", section_,
        section_));
  }
  if (mapping.unit == "hhmmss") {
    if (!of_day) {
      throw UsageError(fmt::format(
          "{}.time.unit: hhmmss is of system seconds_of_day; with a column `date`, system: iso8601 "
          "reads such times",
          section_));
    }
    kind_ = Kind::hhmmss;
  } else {
    static const std::map<std::string, int> kDecimals{{"s", 9}, {"ms", 6}, {"us", 3}, {"ns", 0}};
    decimals_ = kDecimals.at(mapping.unit);
  }
  find_week(mapping, columns);
}

void TimeColumn::find_week(const TimeMapping& mapping, const Columns& columns) {
  if (mapping.add_weeks) add_weeks_ = std::llround(*mapping.add_weeks);
  if (system_ == "gps_week_sow") {
    week_column_ = columns.of("week");
  } else if (system_ == "gps_sow" || system_ == "boot") {
    week_ = std::llround(needed(mapping.gps_week, section_, "gps_week", system_));
    if (system_ == "boot") {
      constexpr int64_t kCounter = int64_t{1} << 32;  // as micros() and millis() have it
      origin_ns_ = nanoseconds(needed(mapping.boot_sow, section_, "boot_sow", system_));
      const int64_t tick_ns = mapping.unit == "ms" ? 1'000'000 : 1'000;
      if (mapping.unit == "us" || mapping.unit == "ms") {
        rolling_.emplace(RollingTime::counter(kCounter * tick_ns));
      }
    } else {
      rolling_.emplace(kNanosecondsPerWeek);
    }
  } else if (system_ != "gps") {
    gps_ = false;
    if (system_ == "excel" || system_ == "matlab_datenum") kind_ = Kind::days;
    if (system_ != "seconds_of_day") return;
    origin_ns_ = parse_date(mapping.date, section_);
    rolling_.emplace(kNanosecondsPerDay);
  }
}

bool TimeColumn::is_text(const Row& row) const {
  return system_ == "iso8601" || row.text(time_).find(':') != std::string_view::npos;
}

int64_t TimeColumn::stamp(const Row& row) {
  if (is_text(row) && system_ != "seconds_of_day") {
    return checked_stamp(row, calendar(row) + offset_ns_);
  }
  const int64_t time_ns = number(row) + origin_ns_ + offset_ns_;
  if (!gps_) return checked_stamp(row, time_ns);
  return gps_stamp(row, week_column_ ? week(row) : week_, time_ns);
}

/// Of its column. Receivers that know ten bits of it lose 1024 or 2048; a run says so by the date.
int64_t TimeColumn::week(const Row& row) const {
  return row.integer(*week_column_) + add_weeks_.value_or(0);
}

int64_t TimeColumn::calendar(const Row& row) const {
  const std::string time(row.text(time_));
  if (gps_) {
    row.fail(
        fmt::format("column {} is '{}', not a number; give time: {{system: iso8601}} for dates "
                    "in UTC",
                    time_ + 1, time));
  }
  if (day_parts_ || time_parts_) {
    std::optional<int64_t> day;
    if (day_parts_) {
      const auto& [year, month, of_month] = *day_parts_;
      day = midnight_ns(row.integer(year), row.integer(month), row.integer(of_month));
    } else if (date_) {
      day = date_ns(row.text(*date_), date_format_);
    }
    if (!day) row.fail("its year, month and day are no date; correct or remove the row");
    return *day + time_of_day(row);
  }
  const std::string text = date_ ? fmt::format("{} {}", row.text(*date_), time) : time;
  if (const std::optional<int64_t> t_ns = calendar_ns(text, date_format_)) return *t_ns;
  row.fail(fmt::format(
      "'{}' is no date and time such as 2024-02-07T11:59:42.02Z; if its date is written in another "
      "way, tell {}.time.date_format, such as \"%d/%m/%Y\", \"%m/%d/%Y\" or \"%d%m%y\"; columns of "
      "parts have the roles year, month, day, hour, minute, second; else correct or remove the "
      "row{}",
      text, section_,
      date_ ? "" : ", name a column `date` beside `time`, or give time: {system: seconds_of_day}"));
}

/// The time column [ns], with what it went on for since the first row.
int64_t TimeColumn::number(const Row& row) {
  const int64_t time_ns = value(row);
  if (!rolling_) return time_ns;
  first_ = false;
  return rolling_->unrolled(time_ns);
}

int64_t TimeColumn::value(const Row& row) const {
  if (kind_ == Kind::days) return day_number(row);
  if (time_parts_ || is_text(row)) return time_of_day(row);
  const int64_t time_ns = kind_ == Kind::hhmmss ? hours_minutes_seconds(row) : plain_number(row);
  check_range(row, time_ns);
  return time_ns;
}

int64_t TimeColumn::plain_number(const Row& row) const {
  const double value = row.number(time_) * std::pow(10.0, decimals_);
  constexpr double kMost = 6.5e18;  // leaves room for offsets
  if (!(std::abs(value) < kMost)) out_of_range(row);
  constexpr int64_t kMostBeside = 1'000'000'000'000;
  if (!nanosecond_) return row.scaled(time_, decimals_);
  const int64_t beside = row.integer(*nanosecond_);
  if (std::abs(beside) > kMostBeside) {
    row.fail(fmt::format("column {} is '{}', no nanoseconds; correct or remove the row",
                         *nanosecond_ + 1, row.text(*nanosecond_)));
  }
  return row.scaled(time_, decimals_) + beside;
}

int64_t TimeColumn::time_of_day(const Row& row) const {
  if (time_parts_) {
    const auto& [hour, minute, second] = *time_parts_;
    const int64_t hours = row.integer(hour);
    const int64_t minutes = row.integer(minute);
    const int64_t seconds_ns = row.scaled(second, kNanosecondDecimals);
    const bool right = hours >= 0 && hours < 24 && minutes >= 0 && minutes < 60 &&
                       seconds_ns >= 0 && seconds_ns < 61 * kNanosecondsPerSecond;
    if (!right)
      row.fail("its hour, minute and second are no time of day; correct or remove the row");
    return (hours * 60 + minutes) * 60 * kNanosecondsPerSecond + seconds_ns;
  }
  if (const std::optional<int64_t> time = time_of_day_ns(row.text(time_))) return *time;
  row.fail(
      fmt::format("'{}' is no time of day; if there is a date in it, give {}.time.system: iso8601, "
                  "else correct or remove the row",
                  row.text(time_), section_));
}

int64_t TimeColumn::hours_minutes_seconds(const Row& row) const {
  const int64_t time_ns = row.scaled(time_, kNanosecondDecimals);
  const int64_t digits = time_ns / kNanosecondsPerSecond;
  const int64_t hours = digits / 10'000;
  const int64_t minutes = digits / 100 % 100;
  const int64_t seconds = digits % 100;
  if (time_ns < 0 || hours > 23 || minutes > 59 || seconds > 60) {
    row.fail(fmt::format("column {} is '{}', no hhmmss; correct or remove the row", time_ + 1,
                         row.text(time_)));
  }
  return ((hours * 60 + minutes) * 60 + seconds) * kNanosecondsPerSecond +
         time_ns % kNanosecondsPerSecond;
}

/// Days since the beginning of Excel's or MATLAB's count, on the UNIX scale [ns].
int64_t TimeColumn::day_number(const Row& row) const {
  constexpr int64_t kExcel1970 = 25'569;
  constexpr int64_t kMatlab1970 = 719'529;
  constexpr int64_t kMostDays = 100'000;
  constexpr int64_t kPartsPerDay = 1'000'000'000'000;
  const int64_t parts = row.scaled(time_, kDecimalsOfDays);
  const int64_t days = parts / kPartsPerDay - (system_ == "excel" ? kExcel1970 : kMatlab1970);
  if (std::abs(days) > kMostDays) {
    row.fail(fmt::format("column {} is '{}', no day of {}; correct or remove the row", time_ + 1,
                         row.text(time_), system_));
  }
  return days * kNanosecondsPerDay + parts % kPartsPerDay * 864 / 10;  // 86.4 ns each
}

/// Zero is a clock that is not set yet.
void TimeColumn::check_range(const Row& row, int64_t time_ns) const {
  if (time_ns == 0) return;
  const TimeRange range = range_of(system_);
  const bool late = system_ == "seconds_of_day" && first_ && time_ns > kNanosecondsPerDay;
  if (!late && time_ns >= range.first_ns && time_ns <= range.last_ns) return;
  out_of_range(row);
}

/// Names what would make a time of it.
void TimeColumn::out_of_range(const Row& row) const {
  const TimeRange range = range_of(system_);
  const double value = row.number(time_);
  std::string remedy = "check column, unit and system of the time";
  for (const auto& [unit, factor] :
       {std::pair("s", 1e9), std::pair("ms", 1e6), std::pair("us", 1e3), std::pair("ns", 1.0)}) {
    const double time_ns = value * factor;
    const bool whole =
        system_ != "seconds_of_day" || time_ns < static_cast<double>(kNanosecondsPerDay);
    if (time_ns < static_cast<double>(range.first_ns) || !whole ||
        time_ns > static_cast<double>(range.last_ns)) {
      continue;
    }
    remedy = fmt::format("if it is in {}, give {}.time.unit: {}", unit, section_, unit);
    break;
  }
  if (system_ == "unix" && value >= 0 && value < 1e6) {
    remedy = fmt::format(
        "if it is a number of days, give {0}.time.system: excel or matlab_datenum, if it counts "
        "from power-up, boot with gps_week and boot_sow, if from the GPS week, gps_sow",
        section_);
  }
  if (system_ == "seconds_of_day" && value < 240'000) {
    remedy = fmt::format("if it is hhmmss, give {}.time.unit: hhmmss", section_);
  }
  row.fail(
      fmt::format("column {} is '{}', out of range, no time {} by system {}; {}, else correct "
                  "or remove the row",
                  time_ + 1, row.text(time_), range.what, system_, remedy));
}

bool has_hhmmss(const TableMapping& mapping, const std::string& path, const std::string& section) {
  if (mapping.time.system != "seconds_of_day" || mapping.time.unit != "s") return false;
  std::vector<std::string> roles;
  for (const auto& [role, name] : mapping.columns) roles.push_back(role);
  TextTable table = open_mapped_table(path);
  const Columns columns(mapping, table, section, roles);
  const std::optional<size_t> time = columns.find("time");
  if (!time) return false;
  bool jumps = false;
  std::optional<std::pair<int64_t, int64_t>> last;  // the number, and as hhmmss [s]
  while (true) {
    try {
      const Row* row = table.next();
      if (row == nullptr) return jumps;
      if (row->text(*time).find(':') != std::string_view::npos) return false;
      const auto digits = static_cast<int64_t>(std::clamp(row->number(*time), -1.0, 1e6));
      const int64_t minutes = digits / 100 % 100;
      if (digits < 0 || digits % 100 > 59 || minutes > 59 || digits >= 240'000) return false;
      const int64_t clock = (digits / 10'000 * 60 + minutes) * 60 + digits % 100;
      if (last && clock > last->second && clock - last->second < 60) {
        jumps = jumps || digits - last->first > clock - last->second;
      }
      last = {digits, clock};
    } catch (const RowError&) {  // told when the table is read
    }
  }
}

}  // namespace foucault::rawlog
