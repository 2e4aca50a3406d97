#include "imu_counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace foucault::rawlog {

namespace {

constexpr double kHalf = 32768;   ///< of 2^16
constexpr double kWhole = 65536;  ///< 2^16

bool begins_hex(std::string_view cell) {
  return cell.size() > 2 && cell[0] == '0' && (cell[1] == 'x' || cell[1] == 'X');
}

bool is_hex_digit(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
bool is_count_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

bool are_digits(std::string_view cell) {
  return !cell.empty() && std::all_of(cell.begin(), cell.end(), is_count_digit);
}

double signed16(double value) { return value < kHalf ? value : value - kWhole; }

/// What the cells of one column have been so far.
struct CountColumn {
  std::optional<double> last;
  double steps = 0;         ///< sum, as they stand
  double signed_steps = 0;  ///< the same, read as signed numbers

  void add(double value) {
    if (last) {
      steps += std::abs(value - *last);
      signed_steps += std::abs(signed16(value) - signed16(*last));
    }
    last = value;
  }
};

/// What all cells have been so far.
class CountSurvey {
 public:
  explicit CountSurvey(size_t columns) : columns_(columns) {}

  void add(size_t column, std::string_view cell) {
    prefixed_ = prefixed_ || begins_hex(cell);
    if (width_ == 0) width_ = cell.size();
    const bool hex = cell.size() == width_ && std::all_of(cell.begin(), cell.end(), is_hex_digit);
    hex_ = hex_ && hex && (width_ == 4 || width_ == 8);
    letters_ = letters_ || !are_digits(cell);
    constexpr size_t kLongest = 5;
    whole_ = whole_ && are_digits(cell) && cell.size() <= kLongest;
    if (whole_) columns_[column].add(std::strtod(std::string(cell).c_str(), nullptr));
  }

  CountFormat format() const {
    constexpr double kSmoother = 4;
    if (prefixed_ || (hex_ && letters_)) return CountFormat::hex;
    const bool smoother =
        std::any_of(columns_.begin(), columns_.end(), [](const CountColumn& column) {
          return column.steps > kHalf && column.steps > kSmoother * column.signed_steps;
        });
    return whole_ && smoother ? CountFormat::uint16 : CountFormat::decimal;
  }

 private:
  std::vector<CountColumn> columns_;
  size_t width_ = 0;
  bool prefixed_ = false, hex_ = true, letters_ = false, whole_ = true;
};

}  // namespace

std::optional<CountFormat> count_format(const std::string& name) {
  if (name == "hex") return CountFormat::hex;
  if (name == "uint16") return CountFormat::uint16;
  return name == "decimal" ? std::optional(CountFormat::decimal) : std::nullopt;
}

CountFormat count_format_of(TextTable& table, const std::vector<size_t>& columns) {
  constexpr int kRows = 5000;
  CountSurvey survey(columns.size());
  for (int i = 0; i < kRows; ++i) {
    const Row* row = table.next();
    if (row == nullptr) break;
    for (size_t k = 0; k < columns.size(); ++k) {
      if (columns[k] < row->size() && !row->is_blank(columns[k])) {
        survey.add(k, row->text(columns[k]));
      }
    }
  }
  return survey.format();
}

double count_of(const Row& row, size_t column, CountFormat format) {
  if (format == CountFormat::decimal) return row.number(column);
  if (format == CountFormat::uint16) {
    const double value = row.number(column);
    if (value >= 0 && value < kWhole && value == std::floor(value)) return signed16(value);
    row.fail(
        fmt::format("column {} is '{}', no count of 0 to 65535; correct or remove the row, or "
                    "give imu.counts: decimal",
                    column + 1, row.text(column)));
  }
  std::string_view digits = row.text(column);
  if (begins_hex(digits)) digits.remove_prefix(2);
  uint32_t value = 0;
  const char* const end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, value, 16);
  constexpr size_t kMostDigits = 8;
  if (read.ec != std::errc{} || read.ptr != end || digits.size() > kMostDigits) {
    row.fail(
        fmt::format("column {} is '{}', no hexadecimal count; correct or remove the row, or "
                    "give imu.counts: decimal",
                    column + 1, row.text(column)));
  }
  const int bits = digits.size() <= 4 ? 16 : digits.size() <= 6 ? 24 : 32;
  const double range = std::ldexp(1.0, bits);
  return value < range / 2 ? value : value - range;
}

}  // namespace foucault::rawlog
