#pragma once

#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "foucault/plot/renderer.h"

/// A figure as files: NAME.csv (the numbers, a header with units), NAME.json (everything else) and
/// NAME.png and NAME.svg (drawn from these two, so that drawing again gives the same bytes).
namespace foucault::plot {

struct FigureText {
  std::string csv;
  std::string json;
};

/// Numbers are written with nine significant digits. Columns of different length end in empty
/// cells; a cell that is empty before its column's end is a gap.
FigureText to_text(const Figure& figure);

/// Throws DataError naming `origin` and the line of what is wrong.
Figure from_text(const FigureText& text, const std::string& origin);

/// Writes NAME.csv, NAME.json, NAME.png and NAME.svg into `folder`. Returns the figure as it was
/// written. Throws DataError if it cannot.
Figure save_figure(const Figure& figure, const std::string& folder, Renderer& renderer);

/// Reads NAME.csv and NAME.json. Throws DataError.
Figure load_figure(const std::string& folder, const std::string& name);

}  // namespace foucault::plot
