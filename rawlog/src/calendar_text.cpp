#include "calendar_text.h"

#include <algorithm>
#include <array>
#include <cctype>
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

void skip_blanks(std::string_view& text) {
  while (take_sign(text, ' ')) continue;
}

/// Takes the decimals of a second off the front [ns]. Behind a colon there are thousandths, or
/// thousandths of those.
std::optional<int64_t> take_fraction(std::string_view& text) {
  constexpr size_t kThousandths = 3;
  const bool colon = take_sign(text, ':');
  if (!colon && !take_sign(text, '.') && !take_sign(text, ',')) return 0;
  const size_t length = text.size();
  int64_t fraction = 0;
  int64_t place = kNanosecondsPerSecond / 10;
  for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1), place /= 10) {
    fraction += place * (text.front() - '0');
  }
  const size_t digits = length - text.size();
  if (colon && (digits == 0 || digits % kThousandths != 0)) return std::nullopt;
  return fraction;
}

bool same_letters(std::string_view text, std::string_view capitals) {
  return text.size() == capitals.size() &&
         std::equal(text.begin(), text.end(), capitals.begin(), [](char a, char b) {
           return std::toupper(static_cast<unsigned char>(a)) == b;
         });
}

/// Takes English letters of a month off the front, three or all; -1 without.
int take_month_name(std::string_view& text) {
  static const std::array<std::string_view, 12> kMonths{
      "JANUARY", "FEBRUARY", "MARCH",     "APRIL",   "MAY",      "JUNE",
      "JULY",    "AUGUST",   "SEPTEMBER", "OCTOBER", "NOVEMBER", "DECEMBER"};
  constexpr size_t kShort = 3;
  for (size_t i = 0; i < kMonths.size(); ++i) {
    for (const size_t length : {kMonths[i].size(), kShort}) {
      if (!same_letters(text.substr(0, length), kMonths[i].substr(0, length))) continue;
      text.remove_prefix(length);
      return static_cast<int>(i) + 1;
    }
  }
  return -1;
}

/// A date as it stands: three parts with a sign between them.
struct DateParts {
  std::array<int, 3> parts{};  ///< -1: none
  size_t year_digits = 0;      ///< of the last part
  char sign = 0;
  bool named = false;  ///< the second is a month's name
};

/// Digits alone are year, month and day.
DateParts take_parts(std::string_view& text) {
  constexpr size_t kYear = 4;
  DateParts date;
  date.parts[0] = take_digits(text, 1, kYear);
  if (!text.empty() && !is_digit(text.front())) date.sign = text.front();
  const auto sign = [&] { return date.sign == 0 || take_sign(text, date.sign); };
  const size_t fewest = date.sign == 0 ? 2 : 1;
  if (!sign()) return date;
  date.parts[1] = take_month_name(text);
  date.named = date.parts[1] > 0;
  if (!date.named) date.parts[1] = take_digits(text, fewest, 2);
  if (!sign()) date.parts[1] = -1;
  const size_t before = text.size();
  date.parts[2] = take_digits(text, fewest, date.sign == 0 ? 2 : kYear);
  date.year_digits = before - text.size();
  return date;
}

/// Of a date that ends with its year: whether the day comes first, if that is certain.
std::optional<bool> day_comes_first(const DateParts& date) {
  constexpr int kLastMonth = 12;
  const auto [first, second, year] = date.parts;
  if (date.sign == '.' || date.named || first > kLastMonth || first == second) return true;
  return second > kLastMonth ? std::optional(false) : std::nullopt;
}

/// Takes a date off the front.
std::optional<int64_t> take_plain_date(std::string_view& text) {
  constexpr std::string_view kSigns = "-/.";
  constexpr int kShortestYear = 1000;
  constexpr int kCentury = 2000;
  const DateParts date = take_parts(text);
  auto [first, second, last] = date.parts;
  if (date.sign != 0 && kSigns.find(date.sign) == std::string_view::npos) return std::nullopt;
  if (first >= kShortestYear) return midnight_ns(first, second, last);
  const std::optional<bool> day_first = day_comes_first(date);
  const bool short_year = date.year_digits == 2 && date.sign == '.' && !date.named;
  if (!day_first || date.sign == 0 || (date.year_digits != 4 && !short_year)) return std::nullopt;
  if (short_year) last += kCentury;
  return *day_first ? midnight_ns(last, second, first) : midnight_ns(last, first, second);
}

std::optional<int64_t> take_date(std::string_view& text, const std::string& format) {
  if (format.empty()) return take_plain_date(text);
  const std::string copy(text);
  std::tm date{};
  const char* end = strptime(copy.c_str(), format.c_str(), &date);
  if (end == nullptr) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(end - copy.c_str()));
  return midnight_ns(date.tm_year + 1900, date.tm_mon + 1, date.tm_mday);
}

/// Takes AM or PM off the front and turns the hours by it; false if they have none of the two.
bool take_half_of_day(std::string_view& text, int& hours) {
  constexpr int kNoon = 12;
  const size_t begin = std::min(text.find_first_not_of(' '), text.size());
  const std::string_view half = text.substr(begin, 2);
  const bool am = same_letters(half, "AM");
  if (!am && !same_letters(half, "PM")) return true;
  text.remove_prefix(begin + 2);
  if (hours < 1 || hours > kNoon) return false;
  hours = hours % kNoon + (am ? 0 : kNoon);
  return true;
}

/// Takes a time of day off the front.
std::optional<int64_t> take_time_of_day(std::string_view& text) {
  const bool compact = text.size() > 2 && is_digit(text[1]) && is_digit(text[2]);
  const auto colon = [&] { return compact || take_sign(text, ':'); };
  int hours = take_digits(text, compact ? 2 : 1, 2);
  if (hours < 0 || hours > 23 || !colon()) return std::nullopt;
  const int minutes = take_digits(text, 2, 2);
  if (minutes < 0 || minutes > 59 || !colon()) return std::nullopt;
  const int seconds = take_digits(text, 2, 2);
  if (seconds < 0 || seconds > 60) return std::nullopt;
  const std::optional<int64_t> fraction = take_fraction(text);
  if (!fraction || !take_half_of_day(text, hours)) return std::nullopt;
  return hours * kHourNs + minutes * kMinuteNs + seconds * kNanosecondsPerSecond + *fraction;
}

/// What a time zone is ahead of UTC [ns].
std::optional<int64_t> zone_ns(std::string_view text) {
  skip_blanks(text);
  if (text.empty() || text == "Z" || text == "z" || text == "UTC" || text == "GMT") return 0;
  const bool west = text.front() == '-';
  if (!take_sign(text, '+') && !take_sign(text, '-')) return std::nullopt;
  const int hours = take_digits(text, 2, 2);
  take_sign(text, ':');
  const int minutes = text.empty() ? 0 : take_digits(text, 2, 2);
  if (hours < 0 || hours > 14 || minutes < 0 || minutes > 59 || !text.empty()) return std::nullopt;
  return (west ? -1 : 1) * (hours * kHourNs + minutes * kMinuteNs);
}

}  // namespace

std::optional<int64_t> midnight_ns(int64_t year, int64_t month, int64_t day) {
  constexpr int64_t kFirstYear = 1950;
  constexpr int64_t kLastYear = 2150;
  if (year < kFirstYear || year > kLastYear || month < 1 || month > 12 || day < 1 || day > 31) {
    return std::nullopt;
  }
  std::tm utc{};
  utc.tm_year = static_cast<int>(year - 1900);
  utc.tm_mon = static_cast<int>(month - 1);
  utc.tm_mday = static_cast<int>(day);
  const std::time_t seconds = timegm(&utc);
  if (utc.tm_mday != day) return std::nullopt;
  return static_cast<int64_t>(seconds) * kNanosecondsPerSecond;
}

bool is_date_format(const std::string& format) {
  constexpr std::string_view kDates = "YymdbBhejDF%";
  if (format.find('%') == std::string::npos) return false;
  for (size_t at = format.find('%'); at != std::string::npos; at = format.find('%', at + 2)) {
    if (at + 1 == format.size() || kDates.find(format[at + 1]) == std::string_view::npos) {
      return false;
    }
  }
  return true;
}

std::optional<int64_t> date_ns(std::string_view text, const std::string& format) {
  const std::optional<int64_t> date = take_date(text, format);
  return text.empty() ? date : std::nullopt;
}

std::optional<int64_t> time_of_day_ns(std::string_view text) {
  const std::optional<int64_t> time = take_time_of_day(text);
  return zone_ns(text) == 0 ? time : std::nullopt;
}

std::optional<int64_t> calendar_ns(std::string_view text, const std::string& format) {
  const std::optional<int64_t> date = take_date(text, format);
  if (!date || (!take_sign(text, 'T') && !take_sign(text, ' '))) return std::nullopt;
  skip_blanks(text);
  const std::optional<int64_t> time = take_time_of_day(text);
  const std::optional<int64_t> zone = zone_ns(text);
  if (!time || !zone) return std::nullopt;
  return *date + *time - *zone;
}

}  // namespace foucault::rawlog
