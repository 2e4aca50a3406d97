#pragma once

#include "foucault/state/result.h"

namespace foucault {

/// A new alignment with what an earlier state knew of the biases, its sigmas doubled. A linear
/// update, so that attitude and velocity get their share.
Epoch with_known_biases(const Epoch& aligned, const Epoch& earlier);

}  // namespace foucault
