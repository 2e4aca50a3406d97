#pragma once

#include "foucault/state/epoch.h"

namespace foucault::navigation {

/// A new alignment with what an earlier state knew of biases and slow blocks, its sigmas doubled
/// and its correlations kept. A linear update, so that attitude and velocity get their share.
state::Epoch with_known_biases(const state::Epoch& aligned, const state::Epoch& earlier);

}  // namespace foucault::navigation
