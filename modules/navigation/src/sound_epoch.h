#pragma once

#include <optional>
#include <string>

#include "foucault/state/result.h"

namespace foucault::navigation {

/// Name of the first part of the epoch that is not finite, or of a variance below zero; none if the
/// epoch is a solution.
std::optional<std::string> unsound_part(const state::Epoch& epoch);

}  // namespace foucault::navigation
