#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"

namespace foucault::plot {

/// The font files text is drawn with.
struct Fonts {
  std::string regular;
  std::string bold;
};

/// DejaVu Sans: from $FOUCAULT_FONT (a .ttf file or a folder that holds DejaVuSans.ttf) or from
/// where Debian keeps it. Throws DataError if there is none, naming the package to install.
Fonts find_fonts();

class Drawing;

/// Draws figures without a display: 8 pixels a millimetre (203 dpi), anti-aliased.
/// The same figure gives the same bytes. One renderer serves one thread.
class Renderer {
 public:
  /// Throws DataError if a font cannot be read.
  explicit Renderer(const Fonts& fonts = find_fonts());
  ~Renderer();

  /// The figure as a PNG file's content. Throws DataError if columns of a series differ in length.
  std::vector<unsigned char> png(const Figure& figure);

  /// The same as vectors, for papers: 85 mm wide, a column, or 178 mm if it has panels side by
  /// side; numbers at the axes have 7 pt. Without titles, which are a caption's.
  std::string svg(const Figure& figure);

 private:
  std::unique_ptr<Drawing> drawing_;
};

}  // namespace foucault::plot
