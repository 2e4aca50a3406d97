#include "text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

namespace foucault::rawlog {

namespace {

constexpr size_t kLongestLine = 1U << 16;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

const char* signs_of(TextTable::Separator separator) {
  switch (separator) {
    case TextTable::Separator::comma:
      return ",";
    case TextTable::Separator::semicolon:
      return ";";
    case TextTable::Separator::tab:
      return "\t";
    case TextTable::Separator::space:
      return " \t\r";
    case TextTable::Separator::space_or_comma:
      break;
  }
  return " \t\r,";
}

/// Behind the field that begins at `begin`: the next of `signs` that no quotes enclose.
size_t end_of_field(std::string_view line, size_t begin, const char* signs) {
  const size_t first = line.find_first_not_of(' ', begin);
  if (first != std::string_view::npos && line[first] == '"') {
    const size_t closing = line.find('"', first + 1);
    if (closing != std::string_view::npos) begin = closing;
  }
  return line.find_first_of(signs, begin);
}

std::string_view without_quotes(std::string_view field) {
  field = trimmed(field);
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return field;
  return trimmed(field.substr(1, field.size() - 2));
}

/// Where `sign` stands between the digits of a number.
std::optional<size_t> decimal_sign(std::string_view field, char sign) {
  const size_t at = field.find(sign);
  if (at == std::string_view::npos) return std::nullopt;
  std::string number(field);
  number[at] = '.';
  const char* begin = number.c_str() + (number.front() == '+' ? 1 : 0);
  const char* end = number.c_str() + number.size();
  double value = 0;
  const auto read = std::from_chars(begin, end, value);
  return read.ec == std::errc{} && read.ptr == end ? std::optional(at) : std::nullopt;
}

}  // namespace

std::string_view Row::text(size_t column) const {
  if (column >= fields_.size()) {
    fail(fmt::format("the row has {} columns, column {} is needed; complete or remove it",
                     fields_.size(), column + 1));
  }
  return fields_[column];
}

bool Row::is_blank(size_t column) const {
  static const std::set<std::string> kWords{"",    "nan", "-nan", "+nan", "null", "none",
                                            "nil", "na",  "n/a",  "-",    "--"};
  constexpr size_t kLongest = 4;
  const std::string_view field = text(column);
  if (field.size() > kLongest) return false;
  std::string word(field);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kWords.count(word) > 0;
}

double Row::number(size_t column) const {
  std::string_view field = text(column);
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size()) {
    fail(fmt::format(
        "column {} is '{}', not a number; {}correct or remove the row", column + 1, text(column),
        decimal_sign(field, ',') ? "if that is a decimal comma, give decimal: comma in "
                                   "the mapping, else "
                                 : ""));
  }
  if (!std::isfinite(value)) {
    fail(fmt::format("column {} is '{}', not finite; correct or remove the row", column + 1,
                     text(column)));
  }
  return value;
}

int64_t Row::integer(size_t column) const {
  const double value = number(column);
  if (value != std::round(value) || std::abs(value) > 1e15) {
    fail(fmt::format("column {} is '{}', not a whole number; correct or remove the row", column + 1,
                     text(column)));
  }
  return std::llround(value);
}

int64_t Row::scaled(size_t column, int decimals) const {
  const double rounded = number(column) * std::pow(10.0, decimals);
  constexpr double kMost = 6.5e18;  // leaves room for offsets
  if (!(std::abs(rounded) < kMost)) {
    fail(fmt::format("column {} is '{}', out of range; correct or remove the row", column + 1,
                     text(column)));
  }
  const std::string_view field = text(column);
  if (field.find_first_not_of("+-0123456789.") != std::string_view::npos) {
    return std::llround(rounded);  // with an exponent
  }
  const size_t point = std::min(field.find('.'), field.size());
  std::string digits(field.substr(0, point));
  std::string_view fraction = point < field.size() ? field.substr(point + 1) : std::string_view{};
  fraction = fraction.substr(0, static_cast<size_t>(decimals));
  digits.append(fraction);
  digits.append(static_cast<size_t>(decimals) - fraction.size(), '0');
  return std::strtoll(digits.c_str(), nullptr, 10);
}

double Row::sigma(size_t column, const std::string& constant) const {
  const double value = number(column);
  if (value > 0) return value;
  const std::string unknown =
      value == 0 && !constant.empty()
          ? fmt::format("; if zero means unknown, leave the columns out and give {}", constant)
          : "";
  fail(
      fmt::format("the sigma in column {} is {}, it must be greater than zero; correct or "
                  "remove the row{}",
                  column + 1, text(column), unknown));
}

std::string Row::where() const { return fmt::format("{}:{}", *path_, line_); }

TextTable::TextTable(const std::string& path, Separator separator, std::string comment_signs,
                     std::string named)
    : path_(std::move(named)),
      separator_(separator),
      comment_signs_(std::move(comment_signs)),
      file_(open_for_reading(path)),
      buffer_(kLongestLine, '\0') {
  gzbuffer(file_.get(), kGzipBuffer);
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  file_size_ = error ? 0 : static_cast<double>(size);
  row_.path_ = &path_;
}

void TextTable::read_as(Separator separator, Decimal decimal) {
  separator_ = separator;
  decimal_ = decimal;
}

std::optional<std::string_view> TextTable::next_line() {
  if (ahead_.empty()) {
    const std::optional<std::string_view> line = read_line();
    row_.line_ = lines_read_;
    return line;
  }
  const std::string_view line(buffer_.data(), ahead_.front().copy(buffer_.data(), kLongestLine));
  ahead_.pop_front();
  ++row_.line_;
  return line;
}

const std::deque<std::string>& TextTable::preview(size_t lines) {
  while (ahead_.size() < lines) {
    const std::optional<std::string_view> line = read_line();
    if (!line) break;
    ahead_.emplace_back(*line);
  }
  return ahead_;
}

std::optional<std::string_view> TextTable::read_line() {
  const std::optional<std::string_view> line = read_bytes();
  return line ? std::optional(line->substr(0, line->find('\0'))) : std::nullopt;
}

std::optional<std::string_view> TextTable::next_bytes() {
  const std::optional<std::string_view> line = read_bytes();
  row_.line_ = lines_read_;
  return line;
}

std::optional<std::string_view> TextTable::read_bytes() {
  const z_off_t begin = gztell(file_.get());
  if (gzgets(file_.get(), buffer_.data(), static_cast<int>(buffer_.size())) == nullptr) {
    int error = Z_OK;
    gzerror(file_.get(), &error);
    if (error != Z_OK && error != Z_STREAM_END) {
      throw DataError(fmt::format("'{}' is truncated or damaged after line {}; copy it again",
                                  path_, lines_read_));
    }
    return std::nullopt;
  }
  ++lines_read_;
  const auto length = static_cast<size_t>(gztell(file_.get()) - begin);
  if (length + 1 == buffer_.size()) {
    throw DataError(
        fmt::format("{}:{}: the line is longer than {} characters; is this a text file?", path_,
                    lines_read_, kLongestLine - 1));
  }
  std::string_view line(buffer_.data(), length);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (lines_read_ == 1 && line.substr(0, 3) == kByteOrderMark) line.remove_prefix(3);
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

const Row* TextTable::next() {
  while (const std::optional<std::string_view> line = next_line()) {
    const std::string_view text = trimmed(*line);
    if (text.empty() || comment_signs_.find(text.front()) != std::string::npos) continue;
    return &split(*line);
  }
  return nullptr;
}

/// In the buffer, to which the fields point.
void TextTable::turn_decimal_commas() {
  if (decimal_ == Decimal::point) return;
  const bool found = decimal_ == Decimal::automatic;
  if (found && (separator_ == Separator::comma || separator_ == Separator::space_or_comma)) return;
  std::vector<char*> commas;
  for (const std::string_view field : row_.fields_) {
    if (const std::optional<size_t> at = decimal_sign(field, ',')) {
      commas.push_back(buffer_.data() + (field.data() - buffer_.data()) + *at);
    }
  }
  const auto has_point = [](std::string_view field) {
    return decimal_sign(field, '.').has_value();
  };
  if (commas.empty() || (found && std::any_of(row_.fields_.begin(), row_.fields_.end(), has_point)))
    return;
  for (char* comma : commas) *comma = '.';
}

const Row& TextTable::split(std::string_view line) {
  cut(line, separator_, row_.fields_);
  turn_decimal_commas();
  return row_;
}

void cut(std::string_view line, TextTable::Separator separator,
         std::vector<std::string_view>& fields) {
  const char* signs = signs_of(separator);
  const bool runs = std::strlen(signs) > 1;  // many blanks separate as one does
  fields.clear();
  size_t begin = runs ? line.find_first_not_of(signs) : 0;
  while (begin != std::string_view::npos) {
    const size_t end = end_of_field(line, begin, signs);
    fields.push_back(without_quotes(line.substr(begin, end - begin)));
    if (end == std::string_view::npos) return;
    begin = runs ? line.find_first_not_of(signs, end) : end + 1;
  }
}

std::string TextTable::place(int64_t line) const { return fmt::format("{}:{}", path_, line); }

double TextTable::progress() const {
  return file_size_ > 0 ? std::min(1.0, static_cast<double>(gzoffset(file_.get())) / file_size_)
                        : 1.0;
}

}  // namespace foucault::rawlog
