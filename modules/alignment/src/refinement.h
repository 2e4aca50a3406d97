#pragma once

#include <functional>
#include <optional>

#include "track.h"
#include "trial.h"

namespace foucault::alignment {

/// A start that leads to what it was found from.
struct Refined {
  state::Epoch start;
  state::Epoch end;     ///< of a filter that drives from it over the track
  Agreement agreement;  ///< of that filter
  double level = 1;     ///< see Trial
  double settling = 1;  ///< see Trial
};

/// Drives from a start over what follows it.
Refined drive_over(const state::Epoch& start, const std::deque<Step>& steps,
                   const imu::ImuNoise& noise, const state::Layout& layout);

/// Gives a start for the attitude found at a later time; none if nothing can be started from.
using MakeStart =
    std::function<std::optional<state::Epoch>(const state::Epoch& found, double level)>;

/// A filter whose attitude was far off linearized at the wrong place, and believes itself too much.
/// From the attitude it came to, carried back to the start, it drives again: Gauss-Newton over the
/// whole way, until the start stays within a fifth of its sigma.
std::optional<Refined> refine(const state::Epoch& found, double level,
                              const std::deque<Step>& steps, const imu::ImuNoise& noise,
                              const state::Layout& layout, const MakeStart& make_start);

}  // namespace foucault::alignment
