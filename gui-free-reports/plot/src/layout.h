#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canvas.h"
#include "foucault/plot/axis_scale.h"
#include "legend.h"

namespace foucault::plot {

/// A panel and its place on the page.
struct PlacedPanel {
  const Panel* panel = nullptr;
  cv::Rect plot;  ///< inside of the axes [px]
  AxisScale x;
  AxisScale y;
  Ticks x_ticks;
  Ticks y_ticks;
  std::optional<AxisScale> colour;
  bool has_x_labels = true;
  double left_of_labels = 0;  ///< x of the y axis' title [px]
  std::optional<Legend> legend;
  std::vector<std::string> notes;  ///< the panel's note in lines; the title stands on the first
};

struct Layout {
  cv::Size page;
  double legend_top = 0;
  std::optional<Legend> legend;
  std::vector<PlacedPanel> panels;
};

Layout lay_out(const Figure& figure, Typesetter& typesetter);

}  // namespace foucault::plot
