#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

/// Latitudes and longitudes as they stand in one cell: 47.5, 47 30 0, 47:30:0.5, 47°30'0"N, W8.25.
namespace foucault::rawlog {

/// Which way an angle counts.
enum class Hemisphere { north, south, east, west };

/// A letter or a word, in upper or lower case.
std::optional<Hemisphere> hemisphere_of(std::string_view text);

struct CoordinateText {
  std::array<double, 3> parts{};  ///< without sign: a number, or degrees, minutes, seconds
  size_t count = 0;
  bool negative = false;  ///< -0, too
  std::optional<Hemisphere> hemisphere;
};

/// None if it is no such text.
std::optional<CoordinateText> coordinate_of(std::string_view cell);

}  // namespace foucault::rawlog
