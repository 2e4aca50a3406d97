#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Dates and times of day as tables write them.
namespace foucault::rawlog {

/// Midnight on the UNIX scale [ns]; none if there is no such day in the years 1950 to 2150.
std::optional<int64_t> midnight_ns(int64_t year, int64_t month, int64_t day);

/// Whether strptime's `format` tells a date and nothing else.
bool is_date_format(const std::string& format);

/// Midnight of a date on the UNIX scale [ns]. Without strptime's `format`: `2024-02-07`,
/// `20240207`, `07.02.2024`, `07.02.24`, `07-Feb-2024`, with other signs too. Of dates that begin
/// with day or month and have strokes, those of which one part is no month; the others may be
/// either, and are none.
std::optional<int64_t> date_ns(std::string_view text, const std::string& format = {});

/// `11:59:42.02`, with a comma too, `11:59:42:020` or `115942.02`, and AM or PM, since midnight
/// [ns]; `Z`, `UTC` and `GMT` may follow. The last second of a day may be a leap second.
std::optional<int64_t> time_of_day_ns(std::string_view text);

/// A date and a time of day with `T` or a blank between them, and behind them nothing, `Z`, `UTC`,
/// `GMT` or the offset of a time zone such as `+01:00`, on the UNIX scale [ns].
std::optional<int64_t> calendar_ns(std::string_view text, const std::string& format = {});

}  // namespace foucault::rawlog
