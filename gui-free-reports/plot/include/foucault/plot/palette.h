#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// The colours of figures: the eight of Okabe and Ito (2008), told apart by readers with any kind
/// of colour vision, and greys.
namespace foucault::plot {

enum class Ink {
  black,
  gray,
  light_gray,
  blue,
  orange,
  green,
  vermillion,
  sky,
  purple,
  yellow,
};

struct Rgb {
  uint8_t red = 0;
  uint8_t green = 0;
  uint8_t blue = 0;
};

Rgb rgb(Ink ink);

/// Colour of the i-th of several equal curves; begins anew after seven.
Ink ink_of(size_t i);

/// Name in files and back. Throws DataError for an unknown name.
std::string_view ink_name(Ink ink);
Ink ink_from_name(std::string_view name);

/// Perceptually even map from 0..1 to dark violet .. yellow (viridis); the value is clamped.
Rgb colormap(double value);

}  // namespace foucault::plot
