#pragma once

namespace foucault::diagnosis {

/// Longest time without samples over which a motion is taken to go on [s]: in more, bumps or a turn
/// of 6 deg may be missed, and what is added up begins anew.
constexpr double kLongestMissing = 0.1;

}  // namespace foucault::diagnosis
