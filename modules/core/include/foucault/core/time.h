#pragma once

#include <cstdint>
#include <string>

#include "foucault/core/constants.h"

/// Stamps and time scales.
/// Inside Foucault a stamp is `int64_t t_ns`: nanoseconds since 1970-01-01T00:00:00 UTC on the
/// UNIX scale (as MRPT stamps), exact in integers; a duration is `double` seconds.
/// GPS week and second of week occur at the edges only; leap seconds are taken by date.
namespace foucault {

constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr int64_t kNanosecondsPerDay = kSecondsPerDay * kNanosecondsPerSecond;
constexpr int64_t kNanosecondsPerWeek = kSecondsPerWeek * kNanosecondsPerSecond;

/// end - begin [s].
constexpr double seconds_between(int64_t begin_ns, int64_t end_ns) {
  return static_cast<double>(end_ns - begin_ns) / 1e9;
}

/// Nearest stamp to `seconds`, a duration or a date [s].
/// Throws std::invalid_argument if it is not finite or does not fit.
int64_t nanoseconds(double seconds);

/// The stamp as seconds [s]; good to about 0.2 us for today's dates.
constexpr double to_seconds(int64_t t_ns) { return static_cast<double>(t_ns) / 1e9; }

/// The stamp in messages for people, everywhere in this form: `2024-05-01T12:34:56.789Z`, what is
/// below a millisecond cut off.
std::string utc_text(int64_t t_ns);

constexpr int64_t kGpsEpochNs = 315'964'800 * kNanosecondsPerSecond;  ///< 1980-01-06

/// GPS time: full week count since 1980-01-06 and second of week, kept in nanoseconds.
struct GpsTime {
  int week = 0;
  int64_t tow_ns = 0;  ///< [ns], 0 <= tow_ns < 604800e9
};

/// GPS second of week with three decimals, cut off as those of utc_text().
std::string gps_second_text(int64_t t_ns);

/// Both clocks that readers use: `2024-05-01T12:34:56.789Z, GPS week 2312 304514.789 s`.
std::string clock_text(int64_t t_ns);

/// GPS minus UTC [s] at a UTC instant (18 since 2017-01-01; 0 before 1981-07-01).
int gps_utc_offset_s(int64_t utc_ns);

/// GPS week and second of week [s] to a UNIX stamp. `sow` may lie outside one week. In an inserted
/// leap second the stamp is one second ahead of UTC, as that second has no name on the UNIX scale.
int64_t gps_to_unix_ns(int week, double sow);
int64_t gps_to_unix_ns(const GpsTime& gps);

/// The inverse; exact on nanoseconds outside an inserted leap second.
GpsTime unix_to_gps(int64_t t_ns);

}  // namespace foucault
