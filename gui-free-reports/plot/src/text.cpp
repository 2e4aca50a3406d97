#include "foucault/plot/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace foucault::plot {
namespace {

std::string with_thin_spaces(std::string digits) {
  const size_t point = std::min(digits.find('.'), digits.size());
  if (point < 5) return digits;
  for (size_t i = point; i > 3; i -= 3) digits.insert(i - 3, "\u2009");
  return digits;
}

}  // namespace

std::string number_text(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  const std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool is_zero = digits.find_first_not_of("0.") == std::string::npos;
  return (value < 0 && !is_zero ? "−" : "") + with_thin_spaces(digits);
}

std::string significant_text(double value, int significant) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const int magnitude = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
  if (magnitude < -5 || magnitude > 8) {
    return number_text(value / std::pow(10, magnitude), significant - 1) + "×" +
           power_of_ten(magnitude);
  }
  return number_text(value, std::max(0, significant - 1 - magnitude));
}

std::string power_of_ten(int exponent) {
  constexpr std::array<const char*, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = "10";
  for (const char c : std::to_string(exponent)) {
    text += c == '-' ? "⁻" : kDigits[static_cast<size_t>(c - '0')];
  }
  return text;
}

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
  std::string text;
  for (const std::string& part : parts) {
    if (!part.empty()) text += (text.empty() ? "" : between) + part;
  }
  return text;
}

}  // namespace foucault::plot
