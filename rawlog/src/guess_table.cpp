#include "guess_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "calendar_text.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "table_columns.h"
#include "text_table.h"

namespace foucault::rawlog {

namespace {

using Separator = TextTable::Separator;

constexpr size_t kPreviewLines = 200;
constexpr size_t kMostCells = 20'000'000;  ///< that are kept
constexpr size_t kMostTexts = 24;          ///< of a column of qualities
constexpr double kNoCell = std::numeric_limits<double>::quiet_NaN();

std::optional<double> number_in(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// With a point or a comma.
bool is_number(std::string_view text) {
  std::string point(text);
  std::replace(point.begin(), point.end(), ',', '.');
  return number_in(point).has_value();
}

std::optional<double> seconds(const std::optional<int64_t>& t_ns) {
  return t_ns ? std::optional(to_seconds(*t_ns)) : std::nullopt;
}

std::optional<double> value_in(std::string_view text, CellKind kind) {
  switch (kind) {
    case CellKind::number:
      return number_in(text);
    case CellKind::calendar:
      return seconds(calendar_ns(text));
    case CellKind::time_of_day:
      return text.find(':') == std::string_view::npos ? std::nullopt
                                                      : seconds(time_of_day_ns(text));
    case CellKind::date:
      return seconds(date_ns(text));
    case CellKind::text:
      break;
  }
  return std::nullopt;
}

CellKind kind_of(std::string_view text) {
  for (const CellKind kind :
       {CellKind::number, CellKind::calendar, CellKind::time_of_day, CellKind::date}) {
    if (value_in(text, kind)) return kind;
  }
  return CellKind::text;
}

size_t count_numbers(std::string_view line, Separator separator) {
  std::vector<std::string_view> fields;
  cut(line, separator, fields);
  return static_cast<size_t>(std::count_if(fields.begin(), fields.end(), is_number));
}

/// The one that cuts most numbers out of the last lines of the preview, which are rows.
Separator separator_of(const std::deque<std::string>& lines) {
  Separator best = Separator::comma;
  size_t most = 0;
  for (const Separator separator :
       {Separator::comma, Separator::semicolon, Separator::tab, Separator::space}) {
    size_t numbers = 0;
    for (size_t i = lines.size() / 2; i < lines.size(); ++i) {
      numbers += count_numbers(lines[i], separator);
    }
    if (numbers > most) {
      most = numbers;
      best = separator;
    }
  }
  return best;
}

struct GuessLayout {
  Separator separator = Separator::comma;
  size_t lines_before = 0;  ///< the first row
  std::vector<std::string> names, units;
};

std::vector<std::string> names_in_line(std::string_view line, Separator separator) {
  line.remove_prefix(std::min(line.find_first_not_of("#% \t"), line.size()));
  std::vector<std::string_view> fields;
  cut(line, separator, fields);
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  return {fields.begin(), fields.end()};
}

/// A row has numbers in half of the cells that rows of the preview have them in.
GuessLayout layout_of(const std::deque<std::string>& lines, const std::string& path) {
  GuessLayout layout;
  layout.separator = separator_of(lines);
  std::vector<size_t> numbers;
  for (const std::string& line : lines) numbers.push_back(count_numbers(line, layout.separator));
  const size_t most = numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end());
  if (most < 2) throw DataError(fmt::format("'{}' is no table: no line has two numbers", path));
  const auto is_row = [&](size_t n) { return n >= 2 && 2 * n + 1 >= most; };
  const auto first = std::find_if(numbers.begin(), numbers.end(), is_row);
  layout.lines_before = static_cast<size_t>(first - numbers.begin());
  const size_t width = names_in_line(lines[layout.lines_before], layout.separator).size();
  for (size_t i = 0; i < layout.lines_before; ++i) {
    const std::vector<std::string> names = names_in_line(lines[i], layout.separator);
    if (names.size() < width || names.size() > width + 1) continue;
    (layout.names.empty() ? layout.names : layout.units) = names;
  }
  return layout;
}

/// Without signs that a mapping cannot hold or an editor does not show.
bool is_plain_text(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return c >= 0x20 && c < 0x7F; });
}

/// Names that the importer finds: those that stand there once and are not empty.
void name_columns(GuessTable& table, const GuessLayout& layout) {
  const std::multiset<std::string> names(layout.names.begin(), layout.names.end());
  for (size_t i = 0; i < table.columns.size(); ++i) {
    GuessColumn& column = table.columns[i];
    const std::string name = i < layout.names.size() ? layout.names[i] : "";
    column.key = names.count(name) == 1 && is_plain_text(name) ? name : std::to_string(i + 1);
    column.name = column_name(name, i < layout.units.size() ? layout.units[i] : "");
  }
}

void take_row(GuessTable& table, const Row& row) {
  if (table.columns.size() < row.size()) {
    const size_t before = table.columns.size();
    table.columns.resize(row.size());
    for (size_t i = before; i < row.size(); ++i)
      table.columns[i].values.assign(table.rows, kNoCell);
  }
  for (size_t i = 0; i < table.columns.size(); ++i) {
    GuessColumn& column = table.columns[i];
    column.values.push_back(kNoCell);
    if (i >= row.size() || row.is_blank(i)) continue;
    if (column.filled == 0) column.kind = kind_of(row.text(i));
    ++column.filled;
    const std::string text(row.text(i));
    if (column.texts.size() < kMostTexts && is_plain_text(text)) ++column.texts[text];
    column.values.back() = value_in(row.text(i), column.kind).value_or(kNoCell);
  }
  ++table.rows;
}

}  // namespace

std::optional<size_t> GuessTable::find(const std::string& role) const {
  for (size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].filled > 0 && role_of(columns[i].name) == role) return i;
  }
  return std::nullopt;
}

GuessTable read_guess_table(const std::string& path, size_t most_rows) {
  TextTable text = open_mapped_table(path);
  const GuessLayout layout = layout_of(text.preview(kPreviewLines), path);
  text.read_as(layout.separator, TextTable::Decimal::automatic);
  for (size_t i = 0; i < layout.lines_before; ++i) text.next_line();
  GuessTable table;
  table.path = path;
  table.header = !layout.names.empty();
  while (const Row* row = text.next()) {
    if (table.rows == most_rows || table.rows * table.columns.size() > kMostCells) {
      table.whole = false;
      break;
    }
    take_row(table, *row);
  }
  name_columns(table, layout);
  for (GuessColumn& column : table.columns) {
    column.filled /= std::max<double>(1, static_cast<double>(table.rows));
  }
  return table;
}

}  // namespace foucault::rawlog
