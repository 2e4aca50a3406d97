#include "table_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "calendar_text.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::rawlog {

namespace {

using Separator = TextTable::Separator;
using Names = std::vector<std::string>;

constexpr size_t kMostLinesBefore = 100;  ///< the header
constexpr const char* kCommentSigns = "#%";

std::vector<Separator> separators_of(const TableMapping& mapping) {
  static const std::map<std::string, Separator> kNames{{"comma", Separator::comma},
                                                       {"semicolon", Separator::semicolon},
                                                       {"tab", Separator::tab},
                                                       {"space", Separator::space}};
  const auto found = kNames.find(mapping.separator);
  if (found != kNames.end()) return {found->second};
  return {Separator::comma, Separator::semicolon, Separator::tab, Separator::space};
}

TextTable::Decimal decimal_of(const TableMapping& mapping) {
  if (mapping.decimal == "point") return TextTable::Decimal::point;
  return mapping.decimal == "comma" ? TextTable::Decimal::comma : TextTable::Decimal::automatic;
}

std::optional<size_t> column_number(const std::string& name) {
  size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool whole = error == std::errc{} && end == name.data() + name.size();
  return whole && number > 0 ? std::optional(number) : std::nullopt;
}

std::string_view without_comment_signs(std::string_view text) {
  constexpr const char* kBefore = "#% \t";
  return text.substr(std::min(text.find_first_not_of(kBefore), text.size()));
}

bool is_comment(std::string_view line) {
  const size_t first = line.find_first_not_of(" \t");
  return first != std::string_view::npos &&
         std::string_view(kCommentSigns).find(line[first]) != std::string_view::npos;
}

bool is_empty(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

/// A line as a header; empty columns at its end are none.
Names names_in(std::string_view line, Separator separator) {
  std::vector<std::string_view> fields;
  cut(without_comment_signs(line), separator, fields);
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  Names names;
  for (const std::string_view field : fields) names.emplace_back(without_comment_signs(field));
  return names;
}

/// A line that may be the header.
struct Header {
  Names names;
  size_t line = 0;  ///< from 1 on; 0: none
  Separator separator = Separator::comma;
  size_t found = 0;  ///< of the names that are looked for
  bool comment = false;

  /// The one with more of the names, then the one that is no comment, then the one that is cut.
  bool beats(const Header& other) const {
    if (other.line == 0 || found != other.found) return other.line == 0 || found > other.found;
    if (comment != other.comment) return !comment;
    return line == other.line && names.size() > other.names.size();
  }
};

/// The columns that a mapping tells by name.
Names names_of(const TableMapping& mapping) {
  Names names;
  for (const auto& [role, name] : mapping.columns) {
    if (!column_number(name)) names.push_back(name);
  }
  return names;
}

/// The largest number that the mapping tells a column by.
size_t fewest_columns(const TableMapping& mapping) {
  size_t fewest = 0;
  for (const auto& [role, name] : mapping.columns) {
    fewest = std::max(fewest, column_number(name).value_or(0));
  }
  return fewest;
}

Header header_at(std::string_view line, size_t number, const std::vector<Separator>& separators,
                 const Names& wanted) {
  Header best;
  for (const Separator separator : separators) {
    Header header{names_in(line, separator), number, separator, 0, is_comment(line)};
    header.found = static_cast<size_t>(
        std::count_if(wanted.begin(), wanted.end(), [&](const std::string& name) {
          return std::find(header.names.begin(), header.names.end(), name) != header.names.end();
        }));
    if (header.beats(best)) best = std::move(header);
  }
  return best;
}

/// The first line with all the columns, else the one that has most of their names.
Header find_header(const TableMapping& mapping, TextTable& table) {
  const Names wanted = names_of(mapping);
  const std::vector<Separator> separators = separators_of(mapping);
  const size_t fewest = fewest_columns(mapping);
  Header best;
  size_t number = 0;
  for (const std::string& line : table.preview(kMostLinesBefore)) {
    ++number;
    if (is_empty(line)) continue;
    Header header = header_at(line, number, separators, wanted);
    if (header.found == wanted.size() && header.names.size() >= fewest) return header;
    if (header.beats(best)) best = std::move(header);
  }
  if (best.line == 0) throw DataError(fmt::format("'{}' has no header line", table.path()));
  return best;
}

const std::string* first_row(TextTable& table) {
  for (const std::string& line : table.preview(kMostLinesBefore)) {
    if (!is_empty(line) && !is_comment(line)) return &line;
  }
  return nullptr;
}

/// Of a table without a header.
Separator separator_by_row(const TableMapping& mapping, TextTable& table) {
  const std::vector<Separator> separators = separators_of(mapping);
  const std::string* row = separators.size() > 1 ? first_row(table) : nullptr;
  if (row == nullptr) return separators.front();
  if (row->find(';') != std::string::npos) return Separator::semicolon;
  if (row->find('\t') != std::string::npos) return Separator::tab;
  return row->find(',') != std::string::npos ? Separator::comma : Separator::space;
}

template <class Value>
Value needed(const std::optional<Value>& value, const std::string& section, const char* key,
             const std::string& system) {
  if (value) return *value;
  throw UsageError(
      fmt::format("{}.time.{} is missing; time system '{}' needs it", section, key, system));
}

/// Midnight, UTC.
int64_t parse_date(const std::string& date, const std::string& section) {
  if (const std::optional<int64_t> midnight = date_ns(date)) return *midnight;
  throw UsageError(fmt::format("{}.time.date: '{}' is no date; write YYYY-MM-DD", section, date));
}

}  // namespace

TextTable open_mapped_table(const std::string& path) {
  return TextTable(path, Separator::comma, kCommentSigns);
}

Columns::Columns(const TableMapping& mapping, TextTable& table, const std::string& section,
                 const Names& roles)
    : section_(section) {
  for (const auto& [role, name] : mapping.columns) {
    if (std::find(roles.begin(), roles.end(), role) != roles.end()) continue;
    throw UsageError(fmt::format("{}.columns: '{}' is no role; known: {}", section, role,
                                 fmt::join(roles, ", ")));
  }
  if (!mapping.header) {
    table.read_as(separator_by_row(mapping, table), decimal_of(mapping));
    find_roles(mapping, {}, table.path());
    return;
  }
  const Header header = find_header(mapping, table);
  table.read_as(header.separator, decimal_of(mapping));
  find_roles(mapping, header.names, table.path());
  for (size_t i = 0; i < header.line; ++i) table.next_line();
  const std::string* row = first_row(table);
  if (row != nullptr && has_units(*row, header.separator)) table.next();
}

void Columns::find_roles(const TableMapping& mapping, const Names& header,
                         const std::string& path) {
  width_ = header.size();
  for (const auto& [role, name] : mapping.columns) {
    const auto found = std::find(header.begin(), header.end(), name);
    const std::optional<size_t> number = column_number(name);
    if (found != header.end()) {
      index_[role] = static_cast<size_t>(found - header.begin());
    } else if (number && (width_ == 0 || *number <= width_)) {
      index_[role] = *number - 1;
    } else {
      throw UsageError(
          fmt::format("{}.columns.{}: '{}' has no column '{}'; {}", section_, role, path, name,
                      header.empty() ? "without a header give its number from 1"
                                     : fmt::format("it has {}", fmt::join(header, ", "))));
    }
  }
}

/// A row of words: no column that is used begins as a number does, or is NaN.
bool Columns::has_units(std::string_view line, Separator separator) const {
  std::vector<std::string_view> fields;
  cut(line, separator, fields);
  bool words = false;
  for (const auto& [role, column] : index_) {
    if (column >= fields.size() || fields[column].empty()) continue;
    const auto first = static_cast<unsigned char>(fields[column].front());
    const bool opens = first == '[' || first == '(' || first >= 0x80;  // such as a degree sign
    const bool is_nan = std::tolower(first) == 'n' && fields[column].size() == 3;
    if ((std::isalpha(first) == 0 && !opens) || is_nan) return false;
    words = true;
  }
  return words;
}

bool Columns::has_all(const Names& roles) const {
  return std::all_of(roles.begin(), roles.end(), [this](const std::string& r) { return has(r); });
}

size_t Columns::of(const std::string& role, const std::string& instead) const {
  if (const std::optional<size_t> column = find(role)) return *column;
  throw UsageError(
      fmt::format("{}.columns.{} is missing; name the column{}", section_, role, instead));
}

std::optional<size_t> Columns::find(const std::string& role) const {
  const auto found = index_.find(role);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

void Columns::check_width(const Row& row) {
  if (width_ == 0) width_ = row.size();
  const auto& fields = row.fields();
  size_t size = fields.size();
  while (size > width_ && fields[size - 1].empty()) --size;
  if (size == width_) return;
  row.fail(fmt::format("{} columns, {} expected; correct or remove the row", row.size(), width_));
}

TimeColumn::TimeColumn(const TimeMapping& mapping, const Columns& columns)
    : time_(columns.of("time")),
      date_(columns.find("date")),
      system_(mapping.system),
      offset_ns_(nanoseconds(mapping.offset_s)) {
  static const std::map<std::string, int> kDecimals{{"s", 9}, {"ms", 6}, {"us", 3}, {"ns", 0}};
  decimals_ = kDecimals.at(mapping.unit);
  const std::string& section = columns.section();
  if (system_ == "gps_week_sow") {
    week_column_ = columns.of("week");
  } else if (system_ == "gps_sow" || system_ == "boot") {
    week_ = std::llround(needed(mapping.gps_week, section, "gps_week", system_));
    if (system_ == "boot") {
      origin_ns_ = nanoseconds(needed(mapping.boot_sow, section, "boot_sow", system_));
    } else {
      rolling_.emplace(kNanosecondsPerWeek);
    }
  } else if (system_ != "gps") {
    gps_ = false;
    if (system_ != "seconds_of_day") return;
    origin_ns_ = parse_date(mapping.date, section);
    rolling_.emplace(kSecondsPerDay * kNanosecondsPerSecond);
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
  return gps_stamp(row, week_column_ ? row.integer(*week_column_) : week_, time_ns);
}

int64_t TimeColumn::calendar(const Row& row) const {
  const std::string time(row.text(time_));
  if (gps_) {
    row.fail(
        fmt::format("column {} is '{}', not a number; give time: {{system: iso8601}} for dates "
                    "in UTC",
                    time_ + 1, time));
  }
  const std::string text = date_ ? fmt::format("{} {}", row.text(*date_), time) : time;
  if (const std::optional<int64_t> t_ns = calendar_ns(text)) return *t_ns;
  row.fail(fmt::format(
      "'{}' is no date and time such as 2024-02-07T11:59:42.02Z; correct or remove the row{}", text,
      date_ ? "" : ", name a column `date` beside `time`, or give time: {system: seconds_of_day}"));
}

/// The time column [ns], with what it went on for since the first row.
int64_t TimeColumn::number(const Row& row) {
  int64_t time_ns = 0;
  if (!is_text(row)) {
    time_ns = row.scaled(time_, decimals_);
  } else if (const std::optional<int64_t> time = time_of_day_ns(row.text(time_))) {
    time_ns = *time;
  } else {
    row.fail(fmt::format("'{}' is no time of day; correct or remove the row", row.text(time_)));
  }
  if (!rolling_) return time_ns;
  constexpr int64_t kMost = 1'000'000'000 * kNanosecondsPerSecond;  // some thirty years
  if (std::abs(time_ns) > kMost) {
    row.fail(fmt::format("column {} is '{}', out of range; correct or remove the row", time_ + 1,
                         row.text(time_)));
  }
  return rolling_->unrolled(time_ns);
}

}  // namespace foucault::rawlog
