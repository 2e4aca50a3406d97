#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

/// Dates and times of day as tables write them.
namespace foucault::rawlog {

/// Midnight of `2024-02-07`, `2024/02/07`, `20240207` or `07.02.2024` on the UNIX scale [ns]. Dates
/// that begin with day or month and have slashes may be either, and are none.
std::optional<int64_t> date_ns(std::string_view text);

/// `11:59:42.02`, with a comma too, or `115942.02`, since midnight [ns]. The last second of a day
/// may be a leap second.
std::optional<int64_t> time_of_day_ns(std::string_view text);

/// A date and a time of day with `T` or a blank between them, and behind them nothing, `Z`, `UTC`
/// or the offset of a time zone such as `+01:00`, on the UNIX scale [ns].
std::optional<int64_t> calendar_ns(std::string_view text);

}  // namespace foucault::rawlog
