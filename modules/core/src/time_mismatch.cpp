#include "foucault/core/time_mismatch.h"

#include <fmt/format.h>

#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"

namespace foucault {
namespace {

constexpr double kRollover = 1024.0 * kSecondsPerWeek;
constexpr double kGpsEpoch = static_cast<double>(kGpsEpochNs) / 1e9;  ///< of UNIX time [s]

/// Near a multiple of `unit`, not zero of them.
bool is_multiple(double seconds, double unit, double tolerance) {
  const double times = std::round(seconds / unit);
  return times != 0 && std::abs(seconds - times * unit) < tolerance;
}

std::string amount(double seconds) {
  if (seconds >= kSecondsPerWeek) return fmt::format("{:.2f} weeks", seconds / kSecondsPerWeek);
  if (seconds >= kSecondsPerHour) return fmt::format("{:.2f} hours", seconds / kSecondsPerHour);
  return fmt::format("{:.2f} s", seconds);
}

}  // namespace

std::string describe_mismatch(double gnss_minus_imu_s) {
  const double seconds = std::abs(gnss_minus_imu_s);
  std::string text =
      fmt::format("{} {} the IMU", amount(seconds), gnss_minus_imu_s > 0 ? "after" : "before");
  if (std::abs(seconds - kGpsEpoch) < kSecondsPerDay) {
    text +=
        ", as the epochs of GPS (1980) and UNIX (1970) are; give the right time system in the "
        "import";
  } else if (is_multiple(seconds, kRollover, kSecondsPerWeek)) {
    text += ", a rollover of the GPS week; add or subtract 1024 weeks in the import";
  } else if (is_multiple(seconds, kSecondsPerWeek, 6 * kSecondsPerHour)) {
    text += ", another GPS week; give the right week in the import";
  } else if (is_multiple(seconds, kSecondsPerDay, 0.1 * kSecondsPerHour)) {
    text += ", whole days; give the right date in the import";
  } else if (seconds < 24 * kSecondsPerHour &&
             is_multiple(seconds, kSecondsPerHour, 0.1 * kSecondsPerHour)) {
    text += ", whole hours as between time zones; give an offset in the import";
  } else {
    text += "; check the time systems and offsets of the import";
  }
  return text;
}

}  // namespace foucault
