#pragma once

#include "canvas.h"
#include "layout.h"

namespace foucault::plot {

/// Draws a panel: shades, heat map, grid, series, lines, axes and texts.
void paint_panel(const PlacedPanel& placed, Surface& canvas);

}  // namespace foucault::plot
