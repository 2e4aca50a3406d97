#pragma once

#include <optional>
#include <string_view>

namespace foucault {

/// How a receiver came to its position, from the worst on.
enum class FixQuality { unknown, single, differential, ppp, float_rtk, fixed_rtk };

/// As the enumerator is called; in configurations, tables and outputs.
std::string_view name_of(FixQuality quality);
/// The inverse; none if no quality is called so.
std::optional<FixQuality> fix_quality(std::string_view name);

/// In words, as legends and reports call it: "RTK fixed".
std::string_view words_of(FixQuality quality);

}  // namespace foucault
