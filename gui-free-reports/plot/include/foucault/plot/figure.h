#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "foucault/plot/palette.h"

/// Figures as plain data: what is drawn, with labels and units, and nothing of how.
/// Numbers are stored in the unit of their axis. A y that is not finite is a gap: lines stop there.
namespace foucault::plot {

/// Where there is no value.
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

enum class Mark { line, points, steps, bars, band };
/// How a line is broken, so that lines are told apart without colours.
enum class Dash { none, dashes, long_dashes, dots, dash_dot };
/// `frame` surrounds a cell of a heat map and has no size of its own.
enum class Shape { dot, ring, cross, plus, triangle, square, diamond, star, tick, frame };

/// What the automatic range of the y axis takes from a series: all of it, all but far outliers
/// (half as much again as the range of 99 %), its typical part (10 % to 90 %), or nothing. Points
/// outside the range, and where lines leave it, are drawn as arrowheads on the border.
enum class RangeRole { full, most, typical, none };

/// One of the kinds of point within a series, e.g. a fix type.
struct Category {
  std::string label;
  Ink ink = Ink::gray;
};

/// A curve, a cloud of points, a set of bars or a band. All columns in use are equally long.
struct Series {
  std::string label = {};   ///< in the legend and the CSV header; empty: not in the legend
  std::string column = {};  ///< name of the CSV column; empty: made from the label
  Mark mark = Mark::line;
  Ink ink = Ink::blue;
  Shape shape = Shape::dot;
  double size = 1.2;  ///< line width or marker diameter [pt]
  double opacity = 1;
  Dash dash = Dash::none;
  bool in_legend = true;
  bool value_labels = false;  ///< the number above each bar
  RangeRole range_role = RangeRole::full;
  std::vector<double> x = {};
  std::vector<double> y = {};  ///< not used by a band
  std::vector<double> lower =
      {};  ///< a band's lower edge; lower end of a bar's or point's interval
  std::vector<double> upper = {};     ///< as lower
  std::vector<double> category = {};  ///< index in `categories` of each point, or empty
  std::vector<Category> categories = {};
  std::vector<double> value = {};  ///< drawn through the colormap, or empty
  std::vector<double> time = {};   ///< of points of a path [s since the start], or empty; not drawn
};

/// Linear; logarithmic; seconds shown as s, min or h; named places 0, 1, 2, ...; or degrees of a
/// circle.
enum class AxisKind { linear, log, duration, category, bearing };

struct Axis {
  std::string label = {};
  std::string unit = {};  ///< of the numbers; empty: none
  AxisKind kind = AxisKind::linear;
  std::string shown_unit = {};     ///< the unit of the tick labels if it is another one,
  double shown_factor = 1;         ///< and that unit's numbers divided by the stored ones
  bool zero_centred = false;       ///< the automatic range is symmetric about zero
  bool from_zero = false;          ///< the automatic range begins at zero
  std::optional<double> min = {};  ///< fixes an end of the range
  std::optional<double> max = {};
  double least_span = 0;  ///< the automatic range is at least this wide
  std::vector<std::string> categories = {};
};

/// A stretch of the x axis, e.g. an outage.
struct Shade {
  double begin = 0;
  double end = 0;
  std::string label;  ///< in the legend, once
  Ink ink = Ink::gray;
};

enum class Direction { horizontal, vertical };

struct ReferenceLine {
  Direction direction = Direction::horizontal;
  double at = 0;
  std::string label;  ///< at the end of the line
  Ink ink = Ink::gray;
  bool dashed = true;
};

enum class Side { left, right, above, below, centre };

/// Text at a place, beside it or over it.
struct Annotation {
  double x = 0;
  double y = 0;
  std::string text;
  Side side = Side::right;
  Ink ink = Ink::black;
};

/// Values on a grid of named places: both axes are of kind category, value [row * columns + column]
/// belongs to places (column, row). Not finite: not evaluated. Coloured by the panel's colour axis.
struct HeatMap {
  size_t columns = 0;
  size_t rows = 0;
  std::vector<double> values;
};

enum class LegendPlace { figure, panel, none };

struct Panel {
  std::string title;  ///< above, left
  std::string note;   ///< above, right: e.g. a root mean square with unit
  Axis x;
  Axis y;
  bool equal_aspect = false;  ///< a unit is as long on x as on y
  bool scale_bar = false;     ///< a bar of round length where there is no data (equal_aspect)
  Axis colour;                ///< of the heat map and of series with values
  double height_share = 1;    ///< relative to the other panels of the column
  LegendPlace legend = LegendPlace::figure;
  std::optional<HeatMap> heat_map;
  std::vector<Shade> shades;
  std::vector<Series> series;  ///< later ones are drawn over earlier ones
  std::vector<ReferenceLine> lines;
  std::vector<Annotation> annotations;
};

struct Figure {
  std::string name = {};      ///< of the files; letters, digits, '-' and '_'
  std::string title = {};     ///< what is shown
  std::string subtitle = {};  ///< of what: recording, method
  std::string caption = {};   ///< what one sees and what good looks like; printed by the report
  double width_mm = 250;
  double height_mm = 150;
  int columns = 1;       ///< panels fill row by row
  bool share_x = false;  ///< panels of a column have one x axis, labelled at the bottom
  std::vector<Panel> panels = {};
};

}  // namespace foucault::plot
