#include "table_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <deque>
#include <utility>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

using Separator = TextTable::Separator;
using Names = std::vector<std::string>;
using CellViews = std::vector<std::string_view>;

constexpr size_t kMostLinesBefore = 1000;  ///< the header
constexpr size_t kFirstRows = 100;         ///< that are looked at
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
  bool fits = false;  ///< the rows below

  /// The one with more of the names, then the one that is no comment, then the one that fits, then
  /// the one that is cut.
  bool beats(const Header& other) const {
    if (other.line == 0 || found != other.found) return other.line == 0 || found > other.found;
    if (comment != other.comment) return !comment;
    if (line != other.line) return false;
    return fits != other.fits ? fits : names.size() > other.names.size();
  }
};

/// Rows behind so many lines, cut, as views of the preview.
std::vector<CellViews> first_rows(TextTable& table, size_t behind, Separator separator,
                                  size_t most) {
  std::vector<CellViews> rows;
  const std::deque<std::string>& lines = table.preview(behind + 2 * most);
  for (size_t i = behind; i < lines.size() && rows.size() < most; ++i) {
    if (!is_empty(lines[i]) && !is_comment(lines[i])) cut(lines[i], separator, rows.emplace_back());
  }
  return rows;
}

/// Without empty cells at the end that stand behind `fewest`.
size_t width_of(const CellViews& fields, size_t fewest) {
  size_t size = fields.size();
  while (size > fewest && fields[size - 1].empty()) --size;
  return size;
}

/// Whether one of the next two rows, the first may be one of units, has as many columns; a
/// separator with blanks around it is no name.
bool fits_rows(const Header& header, TextTable& table) {
  const auto is_sign = [](const std::string& name) { return name == "," || name == ";"; };
  if (header.names.size() < 2) return false;
  if (std::any_of(header.names.begin(), header.names.end(), is_sign)) return false;
  const std::vector<CellViews> rows = first_rows(table, header.line, header.separator, 2);
  return std::any_of(rows.begin(), rows.end(), [&](const CellViews& row) {
    return width_of(row, header.names.size()) == header.names.size();
  });
}

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

Header header_at(size_t number, TextTable& table, const std::vector<Separator>& separators,
                 const Names& wanted) {
  const std::string line = table.preview(number)[number - 1];
  Header best;
  for (const Separator separator : separators) {
    Header header{names_in(line, separator), number, separator, 0, is_comment(line)};
    header.fits = fits_rows(header, table);
    header.found = static_cast<size_t>(
        std::count_if(wanted.begin(), wanted.end(), [&](const std::string& name) {
          return std::find(header.names.begin(), header.names.end(), name) != header.names.end();
        }));
    if (header.beats(best)) best = std::move(header);
  }
  return best;
}

bool begins_with_number(const Header& header) {
  if (header.names.empty()) return false;
  const char first = header.names.front().c_str()[0];  // zero if it is empty
  return std::isdigit(static_cast<unsigned char>(first)) != 0 || first == '-' || first == '.';
}

/// The first line with all the columns, else the one that has most of their names.
Header find_header(const TableMapping& mapping, TextTable& table) {
  const Names wanted = names_of(mapping);
  const std::vector<Separator> separators = separators_of(mapping);
  const size_t fewest = fewest_columns(mapping);
  Header best;
  for (size_t number = 1; number <= kMostLinesBefore; ++number) {
    if (table.preview(number).size() < number) break;
    if (is_empty(table.preview(number)[number - 1])) continue;
    Header header = header_at(number, table, separators, wanted);
    const bool row = wanted.empty() && begins_with_number(header);
    if (!row && header.found == wanted.size() && header.names.size() >= fewest) return header;
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

/// Whether columns that are used, but for times, have blanks in them if cut so.
bool has_blanks(const std::string& row, Separator separator, const TableMapping& mapping) {
  CellViews fields;
  cut(row, separator, fields);
  return std::any_of(mapping.columns.begin(), mapping.columns.end(), [&](const auto& column) {
    const size_t number = column_number(column.second).value_or(0);
    if (column.first == "time" || column.first == "date" || number == 0) return false;
    return number <= fields.size() && fields[number - 1].find(' ') != std::string_view::npos;
  });
}

/// Of a table without a header.
Separator separator_by_row(const TableMapping& mapping, TextTable& table) {
  static const std::vector<std::pair<char, Separator>> kSigns{
      {';', Separator::semicolon}, {'\t', Separator::tab}, {',', Separator::comma}};
  const std::vector<Separator> separators = separators_of(mapping);
  const std::string* row = separators.size() > 1 ? first_row(table) : nullptr;
  if (row == nullptr) return separators.front();
  for (const auto& [sign, separator] : kSigns) {
    if (row->find(sign) != std::string::npos && !has_blanks(*row, separator, mapping)) {
      return separator;
    }
  }
  return Separator::space;
}

/// Of rows, if all have the same; the first may be one of units. 0: they differ, or are too few.
size_t common_width(const std::vector<CellViews>& rows, size_t of_header) {
  constexpr size_t kFewest = 3;
  if (rows.size() < kFewest) return 0;
  const size_t width = width_of(rows.back(), of_header);
  const bool same = std::all_of(rows.begin() + 1, rows.end(), [&](const CellViews& row) {
    return width_of(row, of_header) == width;
  });
  return same ? width : 0;
}

/// Columns told by name need a header as wide as the rows.
void check_names(const TableMapping& mapping, const Header& header, size_t width,
                 const std::string& path) {
  if (header.names.empty() || width == header.names.size() || names_of(mapping).empty()) return;
  const bool doubled = width + 2 >= 2 * header.names.size() && header.separator == Separator::comma;
  throw UsageError(fmt::format(
      "'{}' has {} names in its header, line {}, and {} columns in its rows, so that it is open "
      "which name is whose; tell the columns by their numbers from 1, with header: false{}",
      path, header.names.size(), header.line, width,
      doubled ? ", or, if decimal commas stand between separating ones, export it with another "
                "separator"
              : ""));
}

/// The two texts of a column, if pairs of rows that share their time have both, in turn.
std::optional<std::pair<std::string_view, std::string_view>> two_in_turn(
    const std::vector<CellViews>& rows, size_t time, size_t column) {
  constexpr size_t kFewest = 20;
  if (rows.size() < kFewest) return std::nullopt;
  const auto text = [&](size_t row, size_t of) {
    return of < rows[row].size() ? rows[row][of] : std::string_view{};
  };
  const std::pair two(text(0, column), text(1, column));
  if (two.first == two.second) return std::nullopt;
  for (size_t i = 0; i + 1 < rows.size(); i += 2) {
    const bool in_turn = text(i, column) == two.first && text(i + 1, column) == two.second;
    if (!in_turn || text(i, time) != text(i + 1, time)) return std::nullopt;
  }
  return two;
}

void skip_row(TextTable& table) {
  for (bool skipped = false; !skipped;) {
    const std::optional<std::string_view> line = table.next_line();
    skipped = !line || (!is_empty(*line) && !is_comment(*line));
  }
}

}  // namespace

TextTable open_mapped_table(const std::string& path) {
  return TextTable(path, Separator::comma, kCommentSigns);
}

Columns::Columns(const TableMapping& mapping, TextTable& table, const std::string& section,
                 const Names& roles)
    : section_(section) {
  check_roles(mapping, roles);
  Header header;
  header.separator = mapping.header ? Separator::comma : separator_by_row(mapping, table);
  if (mapping.header) header = find_header(mapping, table);
  table.read_as(header.separator, decimal_of(mapping));
  std::vector<CellViews> rows = first_rows(table, header.line, header.separator, kFirstRows);
  if (!mapping.rows.value.empty()) {
    const size_t column =
        find_column("rows.column", mapping.rows.column, header.names, table.path());
    const auto is_other = [&](const CellViews& row) {
      return column >= row.size() || row[column] != mapping.rows.value;
    };
    rows.erase(std::remove_if(rows.begin(), rows.end(), is_other), rows.end());
    table.choose(column, mapping.rows.value);
  }
  const size_t width = common_width(rows, header.names.size());
  width_ = width > 0 ? width : header.names.size();
  check_names(mapping, header, width_, table.path());
  find_roles(mapping, header.names, table.path());
  if (mapping.decimal == "auto" && header.separator != Separator::comma) {
    check_commas(rows, table.path());
  }
  if (mapping.rows.value.empty()) look_for_sensors(header.names, rows, table.path());
  for (size_t i = 0; i < header.line; ++i) table.next_line();
  const std::string* row = first_row(table);
  if (row != nullptr && has_units(*row, header.separator)) skip_row(table);
}

void Columns::check_roles(const TableMapping& mapping, const Names& roles) const {
  for (const auto& [role, name] : mapping.columns) {
    if (std::find(roles.begin(), roles.end(), role) != roles.end()) continue;
    throw UsageError(fmt::format("{}.columns: '{}' is no role; known: {}", section_, role,
                                 fmt::join(roles, ", ")));
  }
}

void Columns::find_roles(const TableMapping& mapping, const Names& header,
                         const std::string& path) {
  for (const auto& [role, name] : mapping.columns) {
    index_[role] = find_column("columns." + role, name, header, path);
  }
}

size_t Columns::find_column(const std::string& key, const std::string& name, const Names& header,
                            const std::string& path) const {
  const auto found = std::find(header.begin(), header.end(), name);
  const auto again = found == header.end() ? found : std::find(found + 1, header.end(), name);
  if (again != header.end()) {
    throw UsageError(fmt::format(
        "{}.{}: '{}' has two columns '{}', {} and {}; give the number of the right one", section_,
        key, path, name, found - header.begin() + 1, again - header.begin() + 1));
  }
  if (found != header.end()) return static_cast<size_t>(found - header.begin());
  const std::optional<size_t> number = column_number(name);
  if (number && (width_ == 0 || *number <= width_)) return *number - 1;
  throw UsageError(fmt::format("{}.{}: '{}' has no column '{}'; {}", section_, key, path, name,
                               header.empty() ? "without a header give its number from 1"
                                              : fmt::format("it has {}", fmt::join(header, ", "))));
}

/// Of numbers that have three digits behind their only comma, all of them.
void Columns::check_commas(const std::vector<CellViews>& rows, const std::string& path) const {
  const std::string_view* doubtful = nullptr;
  for (const CellViews& row : rows) {
    for (const auto& [role, column] : index_) {
      if (column >= row.size() || !decimal_sign(row[column], ',')) continue;
      if (!has_thousands(row[column], ',')) return;
      doubtful = &row[column];
    }
  }
  if (doubtful == nullptr) return;
  throw UsageError(
      fmt::format("'{}': the comma of '{}' may be decimal or stand between thousands; give "
                  "{}.decimal: comma for decimals, or {}.decimal: point for thousands",
                  path, *doubtful, section_, section_));
}

/// Rows that share their time and differ in a column that is not used, in each group alike.
void Columns::look_for_sensors(const Names& header, const std::vector<CellViews>& rows,
                               const std::string& path) {
  const auto time = find("time");
  if (!time || section_ != "imu") return;
  for (size_t column = 0; column < width_; ++column) {
    const auto is_column = [&](const auto& used) { return used.second == column; };
    if (std::any_of(index_.begin(), index_.end(), is_column)) continue;
    const std::optional<std::pair<std::string_view, std::string_view>> two =
        two_in_turn(rows, *time, column);
    if (!two) continue;
    notices_.push_back(fmt::format(
        "{}: two rows share each time and have '{}' and '{}' in column {}; if they are two "
        "sensors, choose one with {}.rows: {{column: {}, value: \"{}\"}}",
        path, two->first, two->second, column < header.size() ? header[column] : "", section_,
        column + 1, two->first));
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
    if ((std::isalpha(first) == 0 && !opens) || is_blank_text(fields[column])) return false;
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
  row.fail(fmt::format(
      "{} columns, {} expected; if there are rows of several kinds, choose some with {}.rows: "
      "{{column: NUMBER, value: TEXT}}, else correct or remove the row",
      row.size(), width_, section_));
}

}  // namespace foucault::rawlog
