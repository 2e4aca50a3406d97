#include "foucault/core/units.h"

#include <fmt/format.h>

#include <ctime>

#include "foucault/core/time.h"

namespace foucault::units {
namespace {

/// Whole seconds towards minus infinity.
int64_t floor_seconds(int64_t t_ns) {
  const int64_t quotient = t_ns / kNanosecondsPerSecond;
  return t_ns % kNanosecondsPerSecond < 0 ? quotient - 1 : quotient;
}

}  // namespace

std::string format_stamp(int64_t t_ns) {
  const int64_t magnitude = t_ns < 0 ? -t_ns : t_ns;
  return fmt::format("{}{}.{:09}", t_ns < 0 ? "-" : "", magnitude / kNanosecondsPerSecond,
                     magnitude % kNanosecondsPerSecond);
}

std::string format_utc(int64_t t_ns) {
  const std::time_t seconds = floor_seconds(t_ns);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

}  // namespace foucault::units
