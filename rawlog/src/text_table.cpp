#include "text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace foucault::rawlog {

namespace {

constexpr size_t kLongestLine = 1U << 16;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

char sign_of(TextTable::Separator separator) {
  switch (separator) {
    case TextTable::Separator::comma:
      return ',';
    case TextTable::Separator::semicolon:
      return ';';
    case TextTable::Separator::tab:
      return '\t';
    case TextTable::Separator::space:
    case TextTable::Separator::space_or_comma:
      break;
  }
  return ' ';
}

}  // namespace

std::string_view Row::text(size_t column) const {
  if (column >= fields_.size()) {
    fail(fmt::format("the row has {} columns, column {} is needed; complete or remove it",
                     fields_.size(), column + 1));
  }
  return fields_[column];
}

double Row::number(size_t column) const {
  std::string_view field = text(column);
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size()) {
    fail(fmt::format("column {} is '{}', not a number; correct or remove the row", column + 1,
                     text(column)));
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

TextTable::TextTable(std::string path, Separator separator, std::string comment_signs)
    : path_(std::move(path)),
      separator_(separator),
      comment_signs_(std::move(comment_signs)),
      file_(open_for_reading(path_)),
      buffer_(kLongestLine, '\0') {
  gzbuffer(file_.get(), kGzipBuffer);
  std::error_code error;
  const auto size = std::filesystem::file_size(path_, error);
  file_size_ = error ? 0 : static_cast<double>(size);
  row_.path_ = &path_;
}

std::optional<std::string_view> TextTable::next_line() {
  if (gzgets(file_.get(), buffer_.data(), static_cast<int>(buffer_.size())) == nullptr) {
    int error = Z_OK;
    gzerror(file_.get(), &error);
    if (error != Z_OK && error != Z_STREAM_END) {
      throw DataError(fmt::format("'{}' is truncated or damaged after line {}; copy it again",
                                  path_, row_.line_));
    }
    return std::nullopt;
  }
  ++row_.line_;
  const size_t length = std::strlen(buffer_.data());
  if (length + 1 == buffer_.size()) {
    throw DataError(
        fmt::format("{}:{}: the line is longer than {} characters; is this a text file?", path_,
                    row_.line_, kLongestLine - 1));
  }
  std::string_view line(buffer_.data(), length);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (row_.line_ == 1 && line.substr(0, 3) == kByteOrderMark) line.remove_prefix(3);
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

const Row* TextTable::next() {
  while (const std::optional<std::string_view> line = next_line()) {
    const std::string_view text = trimmed(*line);
    if (text.empty() || comment_signs_.find(text.front()) != std::string::npos) continue;
    cut(*line);
    return &row_;
  }
  return nullptr;
}

void TextTable::cut_at(const char* signs, std::string_view line) {
  size_t begin = line.find_first_not_of(signs);
  while (begin != std::string_view::npos) {
    const size_t end = line.find_first_of(signs, begin);
    row_.fields_.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(signs, end);
  }
}

void TextTable::cut(std::string_view line) {
  row_.fields_.clear();
  if (separator_ == Separator::space) return cut_at(" \t\r", line);
  if (separator_ == Separator::space_or_comma) return cut_at(" \t\r,", line);
  const char sign = sign_of(separator_);
  size_t begin = 0;
  while (true) {
    const size_t end = line.find(sign, begin);
    row_.fields_.push_back(trimmed(line.substr(begin, end - begin)));
    if (end == std::string_view::npos) return;
    begin = end + 1;
  }
}

std::string TextTable::place(int64_t line) const { return fmt::format("{}:{}", path_, line); }

double TextTable::progress() const {
  return file_size_ > 0 ? std::min(1.0, static_cast<double>(gzoffset(file_.get())) / file_size_)
                        : 1.0;
}

}  // namespace foucault::rawlog
