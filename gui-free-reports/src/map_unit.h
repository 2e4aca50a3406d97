#pragma once

#include "foucault/reports/figure.h"

namespace foucault::reports {

/// Shows the axes of a map in km if it reaches further than 20 km; the numbers stay in metres.
void choose_map_unit(Panel& panel);

}  // namespace foucault::reports
