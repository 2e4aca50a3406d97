#include "coordinate_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>

namespace foucault::rawlog {

namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Blanks, colons and the signs of degrees, minutes and seconds, of which some are not ASCII.
bool parts_coordinate(char c) {
  return static_cast<unsigned char>(c) >= 0x80 || std::string_view(" :'\"").find(c) < 4;
}

std::string_view without_ends(std::string_view text) {
  while (!text.empty() && parts_coordinate(text.front())) text.remove_prefix(1);
  while (!text.empty() && parts_coordinate(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the letters off one end.
std::optional<Hemisphere> take_hemisphere(std::string_view& text) {
  const size_t front =
      static_cast<size_t>(std::find_if_not(text.begin(), text.end(), is_letter) - text.begin());
  const size_t back =
      static_cast<size_t>(std::find_if_not(text.rbegin(), text.rend(), is_letter) - text.rbegin());
  const std::optional<Hemisphere> found = front > 0
                                              ? hemisphere_of(text.substr(0, front))
                                              : hemisphere_of(text.substr(text.size() - back));
  if (!found) return std::nullopt;
  if (front > 0) {
    text.remove_prefix(front);
  } else {
    text.remove_suffix(back);
  }
  text = without_ends(text);
  return found;
}

/// All of `text`, without a sign.
std::optional<double> plain_number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  const bool whole = read.ec == std::errc{} && read.ptr == end;
  return whole && std::isfinite(value) && text.front() != '-' ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<Hemisphere> hemisphere_of(std::string_view text) {
  std::string word(text);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word == "n" || word == "north") return Hemisphere::north;
  if (word == "s" || word == "south") return Hemisphere::south;
  if (word == "e" || word == "east") return Hemisphere::east;
  if (word == "w" || word == "west") return Hemisphere::west;
  return std::nullopt;
}

std::optional<CoordinateText> coordinate_of(std::string_view cell) {
  constexpr std::string_view kMinus = "\xE2\x88\x92";  // U+2212 is no sign of degrees
  CoordinateText found;
  std::string ascii(cell);
  const size_t minus = ascii.find(kMinus);
  if (minus != std::string::npos) ascii.replace(minus, kMinus.size(), "-");
  std::string_view text = without_ends(ascii);
  found.hemisphere = take_hemisphere(text);
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    found.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  while (!text.empty()) {
    const auto end = std::find_if(text.begin(), text.end(), parts_coordinate);
    const auto length = static_cast<size_t>(end - text.begin());
    const std::optional<double> part = plain_number(text.substr(0, length));
    if (!part || found.count == found.parts.size()) return std::nullopt;
    found.parts[found.count++] = *part;
    text = without_ends(text.substr(length));
  }
  return found.count > 0 ? std::optional(found) : std::nullopt;
}

}  // namespace foucault::rawlog
