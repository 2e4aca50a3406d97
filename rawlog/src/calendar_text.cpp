#include "calendar_text.h"

#include <ctime>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"

namespace foucault::rawlog {

namespace {

constexpr int64_t kHourNs = 3600 * kNanosecondsPerSecond;
constexpr int64_t kMinuteNs = 60 * kNanosecondsPerSecond;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes a number of so many digits off the front; -1 without one.
int take_digits(std::string_view& text, size_t fewest, size_t most) {
  int value = 0;
  size_t count = 0;
  while (count < most && count < text.size() && is_digit(text[count])) {
    value = 10 * value + (text[count++] - '0');
  }
  if (count < fewest) return -1;
  text.remove_prefix(count);
  return value;
}

bool take_sign(std::string_view& text, char sign) {
  if (text.empty() || text.front() != sign) return false;
  text.remove_prefix(1);
  return true;
}

/// Takes the decimals of a second off the front [ns].
int64_t take_fraction(std::string_view& text) {
  if (!take_sign(text, '.') && !take_sign(text, ',')) return 0;
  int64_t fraction = 0;
  int64_t place = kNanosecondsPerSecond / 10;
  for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1), place /= 10) {
    fraction += place * (text.front() - '0');
  }
  return fraction;
}

std::optional<int64_t> midnight(int year, int month, int day) {
  std::tm utc{};
  utc.tm_year = year - 1900;
  utc.tm_mon = month - 1;
  utc.tm_mday = day;
  const std::time_t seconds = timegm(&utc);
  const bool exists = utc.tm_mon == month - 1 && utc.tm_mday == day;
  if (!exists || year < 1950 || year > 2150) return std::nullopt;
  return static_cast<int64_t>(seconds) * kNanosecondsPerSecond;
}

/// dd.mm.yyyy
std::optional<int64_t> day_first(std::string_view text) {
  const int day = take_digits(text, 1, 2);
  if (!take_sign(text, '.')) return std::nullopt;
  const int month = take_digits(text, 1, 2);
  if (!take_sign(text, '.')) return std::nullopt;
  const int year = take_digits(text, 4, 4);
  return text.empty() ? midnight(year, month, day) : std::nullopt;
}

/// yyyy-mm-dd, yyyy/mm/dd or yyyymmdd.
std::optional<int64_t> year_first(std::string_view text) {
  const int year = take_digits(text, 4, 4);
  const bool compact = text.size() == 4;
  const char sign = take_sign(text, '/') ? '/' : '-';
  if (!compact && sign == '-' && !take_sign(text, '-')) return std::nullopt;
  const int month = take_digits(text, compact ? 2 : 1, 2);
  if (!compact && !take_sign(text, sign)) return std::nullopt;
  const int day = take_digits(text, compact ? 2 : 1, 2);
  return text.empty() ? midnight(year, month, day) : std::nullopt;
}

/// Takes a time of day off the front.
std::optional<int64_t> take_time_of_day(std::string_view& text) {
  const bool compact = text.size() > 2 && is_digit(text[1]) && is_digit(text[2]);
  const auto colon = [&] { return compact || take_sign(text, ':'); };
  const int hours = take_digits(text, compact ? 2 : 1, 2);
  if (hours < 0 || hours > 23 || !colon()) return std::nullopt;
  const int minutes = take_digits(text, 2, 2);
  if (minutes < 0 || minutes > 59 || !colon()) return std::nullopt;
  const int seconds = take_digits(text, 2, 2);
  if (seconds < 0 || seconds > 60) return std::nullopt;
  return hours * kHourNs + minutes * kMinuteNs + seconds * kNanosecondsPerSecond +
         take_fraction(text);
}

/// What a time zone is ahead of UTC [ns].
std::optional<int64_t> zone_ns(std::string_view text) {
  while (take_sign(text, ' ')) continue;
  if (text.empty() || text == "Z" || text == "z" || text == "UTC") return 0;
  const bool west = text.front() == '-';
  if (!take_sign(text, '+') && !take_sign(text, '-')) return std::nullopt;
  const int hours = take_digits(text, 2, 2);
  take_sign(text, ':');
  const int minutes = text.empty() ? 0 : take_digits(text, 2, 2);
  if (hours < 0 || hours > 14 || minutes < 0 || minutes > 59 || !text.empty()) return std::nullopt;
  return (west ? -1 : 1) * (hours * kHourNs + minutes * kMinuteNs);
}

}  // namespace

std::optional<int64_t> date_ns(std::string_view text) {
  return text.find('.') == std::string_view::npos ? year_first(text) : day_first(text);
}

std::optional<int64_t> time_of_day_ns(std::string_view text) {
  const std::optional<int64_t> time = take_time_of_day(text);
  return text.empty() ? time : std::nullopt;
}

std::optional<int64_t> calendar_ns(std::string_view text) {
  const size_t end = text.find_first_of("T ");
  if (end == std::string_view::npos) return std::nullopt;
  const std::optional<int64_t> date = date_ns(text.substr(0, end));
  const size_t begin = text.find_first_not_of(' ', end + 1);
  if (!date || begin == std::string_view::npos) return std::nullopt;
  text.remove_prefix(begin);
  const std::optional<int64_t> time = take_time_of_day(text);
  const std::optional<int64_t> zone = zone_ns(text);
  if (!time || !zone) return std::nullopt;
  return *date + *time - *zone;
}

}  // namespace foucault::rawlog
