#include "foucault/plot/ticks.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/round_step.h"
#include "foucault/plot/text.h"

namespace foucault::plot {
namespace {

constexpr double kSecondsPerMinute = 60;
constexpr double kSecondsPerHour = 3600;

int decimals_of(double step) {
  return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

/// The power of ten to take out of numbers as large as `largest`: 0 if they read well as they are.
int common_exponent(double largest) {
  if (largest <= 0 || (largest >= 1e-3 && largest < 1e6)) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest) / 3));
}

Ticks stepped(double min, double max, double step, int decimals, double factor) {
  Ticks result;
  const double first = std::ceil(min * factor / step - 1e-9);
  for (int i = 0; i < 1000; ++i) {
    const double shown = (first + i) * step;
    if (shown > max * factor + 1e-9 * step) break;
    result.ticks.push_back({shown / factor, number_text(shown, decimals)});
  }
  return result;
}

double clock_step(double least, const std::vector<double>& steps) {
  const auto found = std::find_if(steps.begin(), steps.end(),
                                  [&](double step) { return step >= least * (1 - 1e-9); });
  return found == steps.end() ? round_step(least) : *found;
}

std::string power_text(int exponent) {
  if (exponent >= 0 && exponent <= 4) return number_text(std::pow(10, exponent), 0);
  if (exponent < 0 && exponent >= -3) return number_text(std::pow(10, exponent), -exponent);
  return power_of_ten(exponent);
}

/// Mantissas to label: of few decades more than the powers of ten.
std::vector<int> log_mantissas(double decades, int count) {
  if (count < 4 || decades >= 2.2) return {1};
  if (decades >= 1.2) return {1, 2, 5};
  return {1, 2, 3, 5, 7};
}

std::string log_label(int mantissa, int exponent) {
  if (mantissa == 1) return power_text(exponent);
  if (exponent < -3 || exponent > 4) return {};
  return number_text(mantissa * std::pow(10, exponent), std::max(0, -exponent));
}

}  // namespace

Ticks linear_ticks(double min, double max, int count, double factor, const std::string& unit) {
  const double largest = std::max(std::abs(min), std::abs(max)) * factor;
  const int exponent = common_exponent(largest);
  const double scaled = factor * std::pow(10, -exponent);
  const double step = round_step((max - min) * scaled / std::max(1, count));
  Ticks result = stepped(min, max, step, decimals_of(step), scaled);
  result.unit = unit;
  if (exponent != 0) result.exponent = "×" + power_of_ten(exponent);
  return result;
}

Ticks log_ticks(double min, double max, int count, const std::string& unit) {
  const double decades = std::log10(max / min);
  if (decades < 0.7) return linear_ticks(min, max, count, 1, unit);
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(1, count))));
  const std::vector<int> mantissas = log_mantissas(decades, count);
  Ticks result;
  result.unit = unit;
  const int first = static_cast<int>(std::floor(std::log10(min) + 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(max) - 1e-9));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int mantissa = 1; mantissa < 10; ++mantissa) {
      const double at = mantissa * std::pow(10, exponent);
      if (at < min * (1 - 1e-9) || at > max * (1 + 1e-9)) continue;
      if (every > 1 && mantissa > 1) continue;
      const bool labelled = exponent % every == 0 && std::find(mantissas.begin(), mantissas.end(),
                                                               mantissa) != mantissas.end();
      result.ticks.push_back({at, labelled ? log_label(mantissa, exponent) : std::string()});
    }
  }
  return result;
}

Ticks bearing_ticks(double min, double max, int count) {
  const double least = (max - min) / std::max(1, count);
  const double step =
      least < 1 ? round_step(least) : clock_step(least, {1, 2, 5, 10, 15, 30, 45, 90});
  Ticks result = stepped(min, max, step, decimals_of(step), 1);
  result.unit = "°";
  return result;
}

Ticks duration_ticks(double min, double max, int count) {
  const double largest = std::max(std::abs(min), std::abs(max));
  const double least = (max - min) / std::max(1, count);
  if (largest <= 300) return linear_ticks(min, max, count, 1, "s");
  const bool in_hours = largest > 5 * kSecondsPerHour;
  const double factor = 1 / (in_hours ? kSecondsPerHour : kSecondsPerMinute);
  const double step = in_hours
                          ? clock_step(least * factor, {0.5, 1, 2, 3, 4, 6, 12, 24, 48})
                          : clock_step(least * factor, {0.5, 1, 2, 5, 10, 15, 20, 30, 60, 120});
  Ticks result = stepped(min, max, step, decimals_of(step), factor);
  result.unit = in_hours ? "h" : "min";
  return result;
}

}  // namespace foucault::plot
