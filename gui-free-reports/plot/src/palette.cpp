#include "foucault/plot/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

struct NamedColour {
  Ink ink;
  std::string_view name;
  Rgb rgb;
};

constexpr std::array<NamedColour, 10> kColours{{
    {Ink::black, "black", {28, 30, 33}},
    {Ink::gray, "gray", {110, 115, 122}},
    {Ink::light_gray, "light_gray", {190, 194, 200}},
    {Ink::blue, "blue", {0, 114, 178}},
    {Ink::orange, "orange", {230, 159, 0}},
    {Ink::green, "green", {0, 158, 115}},
    {Ink::vermillion, "vermillion", {213, 94, 0}},
    {Ink::sky, "sky", {86, 180, 233}},
    {Ink::purple, "purple", {204, 121, 167}},
    {Ink::yellow, "yellow", {240, 228, 66}},
}};

// Nine anchors of viridis (van der Walt and Smith, 2015, CC0).
constexpr std::array<Rgb, 9> kViridis{{{68, 1, 84},
                                       {71, 44, 122},
                                       {59, 81, 139},
                                       {44, 113, 142},
                                       {33, 144, 141},
                                       {39, 173, 129},
                                       {92, 200, 99},
                                       {170, 220, 50},
                                       {253, 231, 37}}};

uint8_t mix(uint8_t from, uint8_t to, double share) {
  return static_cast<uint8_t>(std::lround(from + (to - from) * share));
}

}  // namespace

Rgb rgb(Ink ink) { return kColours.at(static_cast<size_t>(ink)).rgb; }

Ink ink_of(size_t i) {
  constexpr std::array<Ink, 7> kCycle{Ink::blue,   Ink::vermillion, Ink::green, Ink::purple,
                                      Ink::orange, Ink::sky,        Ink::black};
  return kCycle[i % kCycle.size()];
}

std::string_view ink_name(Ink ink) { return kColours.at(static_cast<size_t>(ink)).name; }

Ink ink_from_name(std::string_view name) {
  const auto* const found = std::find_if(kColours.begin(), kColours.end(),
                                         [&](const NamedColour& c) { return c.name == name; });
  if (found == kColours.end()) throw DataError("unknown colour '" + std::string(name) + "'");
  return found->ink;
}

Rgb colormap(double value) {
  const double place = std::clamp(value, 0.0, 1.0) * (kViridis.size() - 1);
  const size_t i = std::min(static_cast<size_t>(place), kViridis.size() - 2);
  const double share = place - static_cast<double>(i);
  const Rgb& a = kViridis[i];
  const Rgb& b = kViridis[i + 1];
  return {mix(a.red, b.red, share), mix(a.green, b.green, share), mix(a.blue, b.blue, share)};
}

}  // namespace foucault::plot
