#include "text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>

namespace foucault::rawlog {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

unsigned char to_byte(char c) { return static_cast<unsigned char>(c); }

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
  if (field.size() < 2 || field.front() != field.back()) return field;
  if (field.front() != '"' && field.front() != '\'') return field;
  return trimmed(field.substr(1, field.size() - 2));
}

std::optional<double> parsed(std::string_view field) {
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  const bool whole = error == std::errc{} && end == field.data() + field.size();
  return whole ? std::optional(value) : std::nullopt;
}

/// With the minus and the exponent of C.
std::string as_in_c(std::string_view field) {
  constexpr std::string_view kMinus = "\xE2\x88\x92";
  std::string text(field);
  for (size_t at = 0; (at = text.find(kMinus, at)) != std::string::npos;) {
    text.replace(at, kMinus.size(), "-");
  }
  const size_t exponent = text.find_first_of("dD");
  if (exponent != std::string::npos && text.find('.') < exponent) text[exponent] = 'e';
  return text;
}

size_t digits_at(std::string_view text, size_t at) {
  return std::min(text.find_first_not_of("0123456789", at), text.size()) - at;
}

/// What may be done about a cell that is no number.
std::string advice(std::string_view field) {
  if (has_thousands(field, ',')) {
    return "if its comma stands between thousands, give decimal: point, if it is a decimal comma, "
           "decimal: comma, else ";
  }
  if (has_thousands(field, '.')) {
    return "if its points stand between thousands, give decimal: comma, else ";
  }
  if (decimal_sign(field, ',')) {
    return "if that is a decimal comma, give decimal: comma in the mapping, else ";
  }
  const bool is_hex = !field.empty() &&
                      field.find_first_not_of("0123456789abcdefABCDEFxX") == std::string_view::npos;
  return is_hex ? "if it is hexadecimal, turn the column into decimal numbers, else " : "";
}

}  // namespace

bool is_blank_text(std::string_view field) {
  static const std::set<std::string> kWords{"nan",   "null",    "none",   "nil",      "na",
                                            "n/a",   "inf",     "#n/a",   "infinity", "#num",
                                            "#num!", "#value!", "#div/0!"};
  constexpr size_t kLongest = 12;
  if (field.find_first_not_of("-.*") == std::string_view::npos) return true;
  if (field.front() == '-' || field.front() == '+') field.remove_prefix(1);
  constexpr std::string_view kOfMicrosoft = "1.#";  // 1.#QNAN, 1.#IND, 1.#INF
  if (field.substr(0, kOfMicrosoft.size()) == kOfMicrosoft) return true;
  if (field.empty() || field.size() > kLongest || std::isdigit(to_byte(field[0])) != 0)
    return false;
  std::string word(field.substr(0, field.find('(')));  // nan(ind)
  std::transform(word.begin(), word.end(), word.begin(),
                 [](char c) { return static_cast<char>(std::tolower(to_byte(c))); });
  return kWords.count(word) > 0;
}

std::optional<size_t> decimal_sign(std::string_view field, char sign) {
  const size_t at = field.find(sign);
  if (at == std::string_view::npos) return std::nullopt;
  std::string number(field);
  number[at] = '.';
  return parsed(number) ? std::optional(at) : std::nullopt;
}

bool has_thousands(std::string_view field, char sign) {
  constexpr size_t kGroup = 3;
  const size_t end = std::min(field.find(sign == ',' ? '.' : ','), field.size());
  if (sign == '.' && end == field.size()) return false;
  size_t at = field.find_first_not_of("+-") == 1 ? 1 : 0;
  const size_t first = digits_at(field, at);
  if (first < 1 || first > kGroup || field[at] == '0') return false;
  at += first;
  if (at == end) return false;
  for (; at < end; at += 1 + kGroup) {
    if (field[at] != sign || digits_at(field, at + 1) != kGroup) return false;
  }
  return at == end && (end == field.size() || end + 1 + digits_at(field, end + 1) == field.size());
}

std::string_view Row::text(size_t column) const {
  if (column >= fields_.size()) {
    fail(fmt::format("the row has {} columns, column {} is needed; complete or remove it",
                     fields_.size(), column + 1));
  }
  return fields_[column];
}

double Row::number(size_t column) const {
  const std::string_view field = text(column);
  std::optional<double> value = parsed(field);
  if (!value) value = parsed(as_in_c(field));
  if (!value) {
    fail(fmt::format("column {} is '{}', not a number; {}correct or remove the row", column + 1,
                     field, advice(field)));
  }
  if (!std::isfinite(*value)) {
    fail(
        fmt::format("column {} is '{}', not finite; correct or remove the row", column + 1, field));
  }
  return *value;
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
      lines_(path, path_) {
  row_.path_ = &path_;
}

void TextTable::read_as(Separator separator, Decimal decimal) {
  separator_ = separator;
  decimal_ = decimal;
}

void TextTable::choose(size_t column, std::string value) {
  chosen_.emplace(column, std::move(value));
}

std::string_view TextTable::keep(std::string_view line) {
  buffer_.assign(line);
  ++row_.line_;
  return buffer_;
}

std::optional<std::string_view> TextTable::next_line() {
  if (ahead_.empty()) {
    const std::optional<std::string_view> line = read_line();
    if (!line) check_end();
    return line ? std::optional(keep(*line)) : std::nullopt;
  }
  const std::string_view line = keep(ahead_.front());
  ahead_.pop_front();
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

/// Without zeros, which stand where a logger lost its power.
std::optional<std::string_view> TextTable::read_line() {
  std::optional<std::string_view> line = lines_.next();
  if (!line) return std::nullopt;
  const size_t length = line->size();
  line->remove_prefix(std::min(line->find_first_not_of('\0'), length));
  line = line->substr(0, line->find('\0'));
  zeros_ += static_cast<int64_t>(length - line->size());
  return line;
}

std::optional<std::string_view> TextTable::next_bytes() {
  const std::optional<std::string_view> line = lines_.next();
  if (!line) check_end();
  return line ? std::optional(keep(*line)) : std::nullopt;
}

void TextTable::check_end() {
  if (!lines_.is_cut() || std::exchange(end_is_told_, true)) return;
  row_.fail("the gzip file is cut off behind this line; get the whole one");
}

std::vector<std::string> TextTable::notices() const {
  const int64_t zeros = zeros_ + lines_.zeros();
  if (zeros == 0) return {};
  return {
      fmt::format("{}: {} bytes of zeros, as a logger leaves them that loses its power, were "
                  "left out",
                  path_, zeros)};
}

const Row* TextTable::next() {
  while (const std::optional<std::string_view> line = next_line()) {
    const std::string_view text = trimmed(*line);
    if (text.empty() || comment_signs_.find(text.front()) != std::string::npos) continue;
    split(*line);
    if (is_chosen()) return &row_;
  }
  return nullptr;
}

bool TextTable::is_chosen() const {
  if (!chosen_) return true;
  const auto& [column, value] = *chosen_;
  return column < row_.size() && row_.fields_[column] == value;
}

/// In the buffer, to which the fields point.
void TextTable::turn_decimal_commas() {
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

/// The sign that is not the decimal one.
void TextTable::drop_thousands() {
  const char sign = decimal_ == Decimal::point ? ',' : '.';
  for (std::string_view& field : row_.fields_) {
    if (!has_thousands(field, sign)) continue;
    char* begin = buffer_.data() + (field.data() - buffer_.data());
    const char* end = std::remove(begin, begin + field.size(), sign);
    field = {begin, static_cast<size_t>(end - begin)};
  }
}

const Row& TextTable::split(std::string_view line) {
  cut(line, separator_, row_.fields_);
  if (decimal_ != Decimal::automatic) drop_thousands();
  if (decimal_ != Decimal::point) turn_decimal_commas();
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

}  // namespace foucault::rawlog
