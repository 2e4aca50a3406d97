#include "foucault/core/time_mismatch.h"

#include <fmt/format.h>

#include <cmath>

namespace foucault {
namespace {

constexpr double kHour = 3600;
constexpr double kWeek = 604800;
constexpr double kRollover = 1024 * kWeek;

/// Near a multiple of `unit`, not zero of them.
bool is_multiple(double seconds, double unit, double tolerance) {
  const double times = std::round(seconds / unit);
  return times != 0 && std::abs(seconds - times * unit) < tolerance;
}

std::string amount(double seconds) {
  if (seconds >= kWeek) return fmt::format("{:.2f} weeks", seconds / kWeek);
  if (seconds >= kHour) return fmt::format("{:.2f} hours", seconds / kHour);
  return fmt::format("{:.2f} s", seconds);
}

}  // namespace

std::string describe_mismatch(double gnss_minus_imu_s) {
  const double seconds = std::abs(gnss_minus_imu_s);
  std::string text =
      fmt::format("{} {} the IMU", amount(seconds), gnss_minus_imu_s > 0 ? "after" : "before");
  if (is_multiple(seconds, kRollover, kWeek)) {
    text += ", a rollover of the GPS week; add or subtract 1024 weeks in the import";
  } else if (is_multiple(seconds, kWeek, 6 * kHour)) {
    text += ", another GPS week; give the right week in the import";
  } else if (seconds < 24 * kHour && is_multiple(seconds, kHour, 0.1 * kHour)) {
    text += ", whole hours as between time zones; give an offset in the import";
  } else {
    text += "; check the time systems and offsets of the import";
  }
  return text;
}

}  // namespace foucault
