#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// What was probably meant by a word that is not known.
namespace foucault {

/// Levenshtein's distance.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The first of `known` that is nearest to `word`; empty if there is none.
std::string nearest_text(std::string_view word, const std::vector<std::string>& known);

}  // namespace foucault
