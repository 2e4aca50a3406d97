#include "foucault/core/time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <stdexcept>
#include <string>

namespace foucault {
namespace {

/// Days from 1970-01-01 to the first day of a month; only for years from 1970 on.
constexpr int64_t days_to(int year, int month) {
  constexpr int kDaysBefore[] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
  const int years = year - 1970;
  const int leap_days = (year - 1969) / 4 - (year - 1901) / 100 + (year - 1601) / 400;
  const bool leap_year = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return 365 * years + leap_days + kDaysBefore[month - 1] + (leap_year && month > 2 ? 1 : 0);
}

constexpr int64_t utc_ns(int year, int month) {
  return days_to(year, month) * kSecondsPerDay * kNanosecondsPerSecond;
}

/// Instants from which GPS - UTC is one second more than before. Source: IERS Bulletin C.
constexpr std::array kLeapSeconds{
    utc_ns(1981, 7), utc_ns(1982, 7), utc_ns(1983, 7), utc_ns(1985, 7), utc_ns(1988, 1),
    utc_ns(1990, 1), utc_ns(1991, 1), utc_ns(1992, 7), utc_ns(1993, 7), utc_ns(1994, 7),
    utc_ns(1996, 1), utc_ns(1997, 7), utc_ns(1999, 1), utc_ns(2006, 1), utc_ns(2009, 1),
    utc_ns(2012, 7), utc_ns(2015, 7), utc_ns(2017, 1)};

/// `gps_ns` nanoseconds since the GPS epoch to UNIX: the offset changes where the new one says so,
/// so an inserted second still has the old one.
int64_t since_gps_epoch_to_unix(int64_t gps_ns) {
  const int64_t uncorrected = kGpsEpochNs + gps_ns;
  int64_t offset_ns = 0;
  for (const int64_t leap : kLeapSeconds) {
    if (uncorrected - (offset_ns + kNanosecondsPerSecond) < leap) break;
    offset_ns += kNanosecondsPerSecond;
  }
  return uncorrected - offset_ns;
}

}  // namespace

int64_t nanoseconds(double seconds) {
  constexpr double kLimit = 9.2e9;  // int64 ends at 9.22e18 ns, 292 years
  if (!(std::abs(seconds) < kLimit)) {
    throw std::invalid_argument("a time of " + std::to_string(seconds) + " s is out of range");
  }
  const double whole = std::floor(seconds);  // apart, so that dates keep their full precision
  return static_cast<int64_t>(whole) * kNanosecondsPerSecond +
         std::llround((seconds - whole) * 1e9);
}

std::string utc_text(int64_t t_ns) {
  const int64_t rest = t_ns % kNanosecondsPerSecond;
  const int64_t below = rest < 0 ? rest + kNanosecondsPerSecond : rest;
  const std::time_t seconds = t_ns / kNanosecondsPerSecond - (rest < 0 ? 1 : 0);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", utc.tm_year + 1900,
                     utc.tm_mon + 1, utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec,
                     below / 1'000'000);
}

std::string gps_second_text(int64_t t_ns) {
  const int64_t ms = unix_to_gps(t_ns).tow_ns / 1'000'000;
  return fmt::format("{}.{:03}", ms / 1000, ms % 1000);
}

std::string clock_text(int64_t t_ns) {
  return fmt::format("{}, GPS week {} {} s", utc_text(t_ns), unix_to_gps(t_ns).week,
                     gps_second_text(t_ns));
}

int gps_utc_offset_s(int64_t utc_ns) {
  const auto next = std::upper_bound(kLeapSeconds.begin(), kLeapSeconds.end(), utc_ns);
  return static_cast<int>(std::distance(kLeapSeconds.begin(), next));
}

int64_t gps_to_unix_ns(int week, double sow) {
  return since_gps_epoch_to_unix(week * kNanosecondsPerWeek + nanoseconds(sow));
}

int64_t gps_to_unix_ns(const GpsTime& gps) {
  return since_gps_epoch_to_unix(gps.week * kNanosecondsPerWeek + gps.tow_ns);
}

GpsTime unix_to_gps(int64_t t_ns) {
  const int64_t gps_ns = t_ns - kGpsEpochNs + gps_utc_offset_s(t_ns) * kNanosecondsPerSecond;
  const int64_t within = gps_ns % kNanosecondsPerWeek;
  const int64_t tow_ns = within < 0 ? within + kNanosecondsPerWeek : within;
  return {static_cast<int>((gps_ns - tow_ns) / kNanosecondsPerWeek), tow_ns};
}

}  // namespace foucault
