#pragma once

#include "foucault/plot/figure.h"

namespace foucault::content {

/// Shows the axes of a map in km if it reaches further than 20 km; the numbers stay in metres.
void choose_map_unit(plot::Panel& panel);

}  // namespace foucault::content
