#include "foucault/core/fix_quality.h"

#include <array>

namespace foucault {
namespace {

struct Names {
  std::string_view name;
  std::string_view words;
};

/// In the order of the enumerators.
constexpr std::array<Names, 6> kNames{{{"unknown", "unknown type"},
                                       {"single", "single point"},
                                       {"differential", "differential"},
                                       {"ppp", "PPP"},
                                       {"float_rtk", "RTK float"},
                                       {"fixed_rtk", "RTK fixed"}}};

const Names& names_of(FixQuality quality) { return kNames.at(static_cast<size_t>(quality)); }

}  // namespace

std::string_view name_of(FixQuality quality) { return names_of(quality).name; }

std::string_view words_of(FixQuality quality) { return names_of(quality).words; }

std::optional<FixQuality> fix_quality(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i].name == name) return static_cast<FixQuality>(i);
  }
  return std::nullopt;
}

}  // namespace foucault
