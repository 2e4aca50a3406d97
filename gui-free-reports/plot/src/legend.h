#pragma once

#include <string>
#include <vector>

#include "canvas.h"
#include "foucault/plot/figure.h"

namespace foucault::plot {

struct LegendEntry {
  enum class Sample { line, marker, patch };
  std::string label;
  Sample sample = Sample::line;
  Ink ink = Ink::blue;
  Shape shape = Shape::dot;
  double size = 1;  ///< [pt]
  double opacity = 1;
  Dash dash = Dash::none;
};

/// One entry a labelled series, fix type or kind of shade that is seen within the axes, in order;
/// equal ones once; at the end one for what lies beyond the axes, if anything does.
std::vector<LegendEntry> legend_entries(const Panel& panel);
void add_missing(const std::vector<LegendEntry>& more, std::vector<LegendEntry>& entries);

/// Entries in rows from left to right, as many a row as fit. Drawn above the data, never over it.
class Legend {
 public:
  Legend(std::vector<LegendEntry> entries, double width_px, Typesetter& typesetter);

  double height() const;  ///< [px], 0 if there are no entries
  double width() const;   ///< of the longest row [px]
  void draw(Surface& canvas, cv::Point2d top_left) const;

 private:
  struct Placed {
    LegendEntry entry;
    double x = 0;
    int row = 0;
  };
  std::vector<Placed> placed_;
  int rows_ = 0;
  double width_ = 0;
};

}  // namespace foucault::plot
