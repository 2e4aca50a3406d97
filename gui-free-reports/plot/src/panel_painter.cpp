#include "panel_painter.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "foucault/plot/text.h"
#include "style.h"

namespace foucault::plot {
namespace {

using style::millimetres;

constexpr int kColourSteps = 32;

cv::Rect grown(const cv::Rect& area, double by) {
  const int margin = int(std::ceil(by));
  return {area.x - margin, area.y - margin, area.width + 2 * margin, area.height + 2 * margin};
}

Polyline rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

bool is_dark(Rgb c) { return 0.299 * c.red + 0.587 * c.green + 0.114 * c.blue < 120; }

class PanelPainter {
 public:
  PanelPainter(const PlacedPanel& placed, Surface& canvas)
      : placed_(placed), panel_(*placed.panel), plot_(placed.plot), canvas_(canvas) {}

  void paint() {
    if (panel_.heat_map) {
      heat_map();
    } else {
      grid();
    }
    shades();
    for (const ReferenceLine& line : panel_.lines) reference_line(line);
    size_t bar_group = 0;
    for (const Series& series : panel_.series) {
      paint_series(series, bar_group);
      if (series.mark == Mark::bars) ++bar_group;
    }
    for (const ReferenceLine& line : panel_.lines) reference_label(line);
    axes();
    for (const Annotation& annotation : panel_.annotations) annotate(annotation);
    if (panel_.scale_bar) scale_bar();
    if (placed_.colour) colour_bar();
    head();
  }

 private:
  double x(double value) const { return placed_.x.pixel(value); }
  double y(double value) const { return placed_.y.pixel(value); }
  bool drawable(double px, double py) const { return std::isfinite(px) && std::isfinite(py); }

  // ---- background

  void shades() {
    for (const Shade& shade : panel_.shades) {
      const double left = std::max(x(shade.begin), double(plot_.x));
      const double right = std::min(x(shade.end), double(plot_.br().x));
      if (!(right > left)) continue;
      canvas_.box(
          {int(std::floor(left)), plot_.y, std::max(3, int(std::ceil(right - left))), plot_.height},
          rgb(shade.ink), style::kShadeOpacity);
    }
  }

  void vertical_rule(double at, int top, int height, int width, Rgb colour) {
    canvas_.box({int(std::lround(at)) - width / 2, top, width, height}, colour);
  }
  void horizontal_rule(double at, int left, int length, int width, Rgb colour) {
    canvas_.box({left, int(std::lround(at)) - width / 2, length, width}, colour);
  }

  void grid() {
    for (const bool major : {false, true}) {
      const Rgb colour = major ? style::kGrid : style::kMinorGrid;
      for (const Tick& tick : placed_.x_ticks.ticks) {
        if (panel_.x.kind == AxisKind::category || tick.label.empty() == major) continue;
        vertical_rule(x(tick.at), plot_.y, plot_.height, style::kGridWidth, colour);
      }
      for (const Tick& tick : placed_.y_ticks.ticks) {
        if (tick.label.empty() == major) continue;
        horizontal_rule(y(tick.at), plot_.x, plot_.width, style::kGridWidth, colour);
      }
    }
  }

  double colour_share(double value) const {
    return (placed_.colour->pixel(value) - plot_.br().y) / -double(plot_.height);
  }

  void heat_map() {
    const HeatMap& map = *panel_.heat_map;
    for (size_t r = 0; r < map.rows; ++r) {
      for (size_t c = 0; c < map.columns; ++c) cell(c, r, map.values.at(r * map.columns + c));
    }
  }

  void cell(size_t column, size_t row, double value) {
    const int left = int(std::lround(x(double(column) - 0.5))) + 1;
    const int right = int(std::lround(x(double(column) + 0.5))) - 1;
    const int top = int(std::lround(y(double(row) + 0.5))) + 1;
    const int bottom = int(std::lround(y(double(row) - 0.5))) - 1;
    const bool known = std::isfinite(value);
    const Rgb colour = known ? colormap(colour_share(value)) : style::kMinorGrid;
    canvas_.box({left, top, right - left, bottom - top}, colour);
    if (right - left < millimetres(13) || bottom - top < millimetres(6)) return;
    const Rgb ink = known && is_dark(colour) ? Rgb{255, 255, 255} : style::kText;
    canvas_.text(significant_text(value), {(left + right) / 2.0, (top + bottom) / 2.0},
                 {style::kTickPoints, ink, AlignX::centre, AlignY::middle});
  }

  // ---- series

  void paint_series(const Series& series, size_t bar_group) {
    switch (series.mark) {
      case Mark::line:
        return curves(series, runs(series));
      case Mark::steps:
        return curves(series, with_corners(runs(series)));
      case Mark::points:
        return points(series);
      case Mark::bars:
        return bars(series, bar_group);
      case Mark::band:
        return band(series);
    }
  }

  /// The stretches of a line between gaps.
  std::vector<Polyline> runs(const Series& series) const {
    std::vector<Polyline> result(1);
    for (size_t i = 0; i < series.x.size(); ++i) {
      const double px = x(series.x[i]);
      const double py = y(series.y[i]);
      if (drawable(px, py)) {
        result.back().emplace_back(px, py);
      } else if (!result.back().empty()) {
        result.emplace_back();
      }
    }
    return result;
  }

  static std::vector<Polyline> with_corners(const std::vector<Polyline>& lines) {
    std::vector<Polyline> result;
    for (const Polyline& line : lines) {
      Polyline steps;
      for (const cv::Point2d& p : line) {
        if (!steps.empty()) steps.emplace_back(p.x, steps.back().y);
        steps.push_back(p);
      }
      result.push_back(std::move(steps));
    }
    return result;
  }

  void curves(const Series& series, const std::vector<Polyline>& lines) {
    const double width = series.size * kPixelsPerPoint;
    if (!series.value.empty()) return coloured_segments(series, width);
    canvas_.polylines(lines, {rgb(series.ink), width, series.opacity, series.dash},
                      grown(plot_, width / 2));
    if (!panel_.equal_aspect) excursions(lines, rgb(series.ink));
  }

  /// Arrowheads where lines leave the axis, one for each time, and none beside another.
  void excursions(const std::vector<Polyline>& lines, Rgb colour) {
    const double head = millimetres(1.6);
    Polyline above, below;
    const auto add = [head](double at, double level, Polyline& tips) {
      if (tips.empty() || std::abs(tips.back().x - at) > head) tips.emplace_back(at, level);
    };
    for (const Polyline& line : lines) {
      for (const cv::Point2d& p : line) {
        if (p.x < plot_.x - 1 || p.x > plot_.br().x + 1) continue;
        if (p.y < plot_.y - 1) add(p.x, plot_.y, above);
        if (p.y > plot_.br().y + 1) add(p.x, plot_.br().y, below);
      }
    }
    canvas_.arrowheads(above, true, head, colour, grown(plot_, head));
    canvas_.arrowheads(below, false, head, colour, grown(plot_, head));
  }

  /// Positions by step of the colormap.
  int colour_step(double value) const {
    return std::clamp(int(colour_share(value) * kColourSteps), 0, kColourSteps - 1);
  }
  static Rgb step_colour(int step) { return colormap((step + 0.5) / kColourSteps); }

  void coloured_segments(const Series& series, double width) {
    std::map<int, std::vector<Polyline>> by_colour;
    for (size_t i = 0; i + 1 < series.x.size(); ++i) {
      const cv::Point2d a(x(series.x[i]), y(series.y[i]));
      const cv::Point2d b(x(series.x[i + 1]), y(series.y[i + 1]));
      if (!drawable(a.x, a.y) || !drawable(b.x, b.y) || !std::isfinite(series.value[i])) continue;
      by_colour[colour_step(series.value[i])].push_back({a, b});
    }
    for (const auto& [step, lines] : by_colour) {
      canvas_.polylines(lines, {step_colour(step), width, series.opacity, Dash::none},
                        grown(plot_, width / 2));
    }
  }

  struct Cloud {
    Rgb colour;
    Polyline places, above, below;
    size_t size() const { return places.size() + above.size() + below.size(); }
  };

  void sort_point(double px, double py, Cloud& cloud) const {
    if (!drawable(px, py) || px < plot_.x - 1 || px > plot_.br().x + 1) return;
    if (py < plot_.y - 1) {
      cloud.above.emplace_back(px, plot_.y);
    } else if (py > plot_.br().y + 1) {
      cloud.below.emplace_back(px, plot_.br().y);
    } else {
      cloud.places.emplace_back(px, py);
    }
  }

  /// Points of one colour each, the most frequent colour first so that rare ones stay visible.
  std::vector<Cloud> clouds(const Series& series) const {
    std::map<int, Cloud> by_key;
    for (size_t i = 0; i < series.x.size(); ++i) {
      int key = 0;
      Rgb colour = rgb(series.ink);
      if (!series.category.empty()) {
        if (!std::isfinite(series.category[i])) continue;
        key = int(series.category[i]);
        colour = rgb(series.categories.at(size_t(key)).ink);
      } else if (!series.value.empty()) {
        if (!std::isfinite(series.value[i])) continue;
        key = colour_step(series.value[i]);
        colour = step_colour(key);
      }
      Cloud& cloud = by_key[key];
      cloud.colour = colour;
      sort_point(x(series.x[i]), y(series.y[i]), cloud);
    }
    std::vector<Cloud> result;
    for (auto& [key, cloud] : by_key) result.push_back(std::move(cloud));
    std::stable_sort(result.begin(), result.end(),
                     [](const Cloud& a, const Cloud& b) { return a.size() > b.size(); });
    return result;
  }

  /// Frames around cells.
  void frames(const Series& series) {
    std::vector<Polyline> outlines;
    for (size_t i = 0; i < series.x.size(); ++i) {
      const double left = x(series.x[i] - 0.5);
      const double right = x(series.x[i] + 0.5);
      const double top = y(series.y[i] + 0.5);
      const double bottom = y(series.y[i] - 0.5);
      if (!drawable(left, top)) continue;
      Polyline outline = rectangle(left, top, right, bottom);
      outline.push_back(outline.front());
      outlines.push_back(std::move(outline));
    }
    const double width = 2.6 * kPixelsPerPoint;
    canvas_.polylines(outlines, {rgb(series.ink), width, 1, Dash::none}, grown(plot_, width));
  }

  void points(const Series& series) {
    if (series.shape == Shape::frame) return frames(series);
    if (!series.lower.empty()) intervals(series, series.x);
    const double diameter = series.size * kPixelsPerPoint;
    for (const Cloud& cloud : clouds(series)) {
      canvas_.markers(cloud.places, series.shape, diameter, cloud.colour, series.opacity,
                      grown(plot_, diameter));
      const double head = std::max(diameter, millimetres(1.6));
      canvas_.arrowheads(cloud.above, true, head, cloud.colour, grown(plot_, head));
      canvas_.arrowheads(cloud.below, false, head, cloud.colour, grown(plot_, head));
    }
  }

  /// Vertical intervals with small caps at the given places.
  void intervals(const Series& series, const std::vector<double>& places) {
    const double cap = millimetres(0.8);
    std::vector<Polyline> lines;
    for (size_t i = 0; i < places.size(); ++i) {
      const double px = x(places[i]);
      const double low = y(series.lower[i]);
      const double high = y(series.upper[i]);
      if (!drawable(px, low) || !std::isfinite(high)) continue;
      lines.push_back({{px, low}, {px, high}});
      lines.push_back({{px - cap, low}, {px + cap, low}});
      lines.push_back({{px - cap, high}, {px + cap, high}});
    }
    const Rgb colour = series.mark == Mark::bars ? style::kText : rgb(series.ink);
    canvas_.polylines(lines, {colour, 1.0 * kPixelsPerPoint, 1, Dash::none}, grown(plot_, 2));
  }

  size_t bar_series() const {
    return size_t(std::count_if(panel_.series.begin(), panel_.series.end(),
                                [](const Series& s) { return s.mark == Mark::bars; }));
  }

  void bars(const Series& series, size_t group) {
    const double width = 0.78 / double(bar_series());
    const double offset = (double(group) + 0.5) * width - 0.39;
    const double base = panel_.y.kind == AxisKind::log ? double(plot_.br().y) : y(0);
    std::vector<Polyline> boxes;
    std::vector<double> centres;
    for (size_t i = 0; i < series.x.size(); ++i) {
      centres.push_back(series.x[i] + offset);
      const double top = y(series.y[i]);
      if (!std::isfinite(top)) continue;
      boxes.push_back(rectangle(x(centres[i] - 0.46 * width), std::min(top, base),
                                x(centres[i] + 0.46 * width), std::max(top, base)));
    }
    canvas_.polygons(boxes, rgb(series.ink), series.opacity, plot_);
    if (!series.lower.empty()) intervals(series, centres);
    if (series.value_labels) bar_labels(series, centres);
  }

  void bar_labels(const Series& series, const std::vector<double>& centres) {
    for (size_t i = 0; i < centres.size(); ++i) {
      if (!std::isfinite(series.y[i])) continue;
      const double top =
          series.upper.empty() ? series.y[i] : std::fmax(series.y[i], series.upper[i]);
      canvas_.text(significant_text(series.y[i], 3), {x(centres[i]), y(top) - millimetres(1.4)},
                   {8, style::kSoftText, AlignX::centre, AlignY::baseline});
    }
  }

  /// Each stretch between gaps as one shape: along its upper edge and back along the lower one.
  void band(const Series& series) {
    std::vector<Polyline> stretches(1);
    std::vector<Polyline> lower(1);
    for (size_t i = 0; i < series.x.size(); ++i) {
      const cv::Point2d low(x(series.x[i]), y(series.lower[i]));
      const cv::Point2d high(low.x, y(series.upper[i]));
      if (drawable(low.x, low.y) && std::isfinite(high.y)) {
        stretches.back().push_back(high);
        lower.back().push_back(low);
      } else if (!lower.back().empty()) {
        stretches.emplace_back();
        lower.emplace_back();
      }
    }
    for (size_t i = 0; i < stretches.size(); ++i) {
      stretches[i].insert(stretches[i].end(), lower[i].rbegin(), lower[i].rend());
    }
    canvas_.polygons(stretches, rgb(series.ink), series.opacity, plot_);
  }

  // ---- foreground

  bool is_shown(const ReferenceLine& line) const {
    return (line.direction == Direction::horizontal ? placed_.y : placed_.x).shows(line.at);
  }

  void reference_line(const ReferenceLine& line) {
    if (!is_shown(line)) return;
    const bool level = line.direction == Direction::horizontal;
    const double at = level ? y(line.at) : x(line.at);
    const Polyline ends = level ? Polyline{{double(plot_.x), at}, {double(plot_.br().x), at}}
                                : Polyline{{at, double(plot_.br().y)}, {at, double(plot_.y)}};
    const Dash dash = line.dashed ? Dash::dashes : Dash::none;
    canvas_.polylines({ends}, {rgb(line.ink), 1.1 * kPixelsPerPoint, 1, dash}, plot_);
  }

  void reference_label(const ReferenceLine& line) {
    if (line.label.empty() || !is_shown(line)) return;
    TextStyle style{style::kNotePoints, rgb(line.ink), AlignX::left, AlignY::baseline};
    style.halo = true;
    const double width = canvas_.typesetter().width(line.label, style::kNotePoints);
    if (line.direction == Direction::horizontal) {
      label_level(line, width, style);
    } else {
      label_upright(line, width, style);
    }
  }

  /// Over the end of the line that has fewer data around it.
  void label_level(const ReferenceLine& line, double width, TextStyle style) {
    const double at = y(line.at);
    const double left = plot_.x + millimetres(1.5);
    const double right = plot_.br().x - millimetres(1.5) - width;
    const auto data_around = [&](double begin) {
      return points_inside(
          grown(cv::Rect(int(begin), int(at - millimetres(4)), int(width), int(millimetres(4))),
                millimetres(3)));
    };
    const double begin = data_around(right) <= data_around(left) ? right : left;
    canvas_.text(line.label, {begin, at - millimetres(1)}, style);
  }

  /// Beside the upper end of the line.
  void label_upright(const ReferenceLine& line, double width, TextStyle style) {
    const double at = x(line.at);
    const bool fits_right = at + width + millimetres(3) < plot_.br().x;
    style.x = fits_right ? AlignX::left : AlignX::right;
    style.y = AlignY::top;
    canvas_.text(line.label,
                 {at + millimetres(fits_right ? 1.2 : -1.2), plot_.y + millimetres(1.5)}, style);
  }

  void axes() {
    const int overlap = style::kSpineWidth / 2;
    vertical_rule(plot_.x, plot_.y, plot_.height + overlap, style::kSpineWidth, style::kSpine);
    horizontal_rule(plot_.br().y, plot_.x - overlap, plot_.width + overlap, style::kSpineWidth,
                    style::kSpine);
    x_axis();
    y_axis();
  }

  void x_axis() {
    const bool is_category = panel_.x.kind == AxisKind::category;
    const int length = int(style::kTickLength);
    for (const Tick& tick : placed_.x_ticks.ticks) {
      const double at = x(tick.at);
      if (!is_category) {
        vertical_rule(at, plot_.br().y, tick.label.empty() ? length / 2 : length,
                      style::kSpineWidth, style::kSpine);
      }
      if (!placed_.has_x_labels) continue;
      canvas_.text(tick.label, {at, plot_.br().y + length + millimetres(1.2)},
                   {style::kTickPoints, style::kSoftText, AlignX::centre, AlignY::top});
    }
    if (!placed_.has_x_labels) return;
    canvas_.text(axis_title(panel_.x, placed_.x_ticks),
                 {plot_.x + plot_.width / 2.0, plot_.br().y + length + millimetres(6.4)},
                 {style::kAxisPoints, style::kText, AlignX::centre, AlignY::top});
  }

  void y_axis() {
    const bool is_category = panel_.y.kind == AxisKind::category;
    const int length = int(style::kTickLength);
    for (const Tick& tick : placed_.y_ticks.ticks) {
      const int reach = is_category ? 0 : tick.label.empty() ? length / 2 : length;
      horizontal_rule(y(tick.at), plot_.x - reach, reach, style::kSpineWidth, style::kSpine);
      canvas_.text(tick.label, {plot_.x - length - millimetres(0.9), y(tick.at)},
                   {style::kTickPoints, style::kSoftText, AlignX::right, AlignY::middle});
    }
    const std::string title = axis_title(panel_.y, placed_.y_ticks);
    TextStyle style{fitting_points(title), style::kText, AlignX::centre, AlignY::top};
    style.upwards = true;
    canvas_.text(title, {placed_.left_of_labels, plot_.y + plot_.height / 2.0}, style);
  }

  /// Of a title that is longer than the axis and a little more: smaller, as far as it can be read.
  double fitting_points(const std::string& title) {
    constexpr double kLeast = 7;
    const double room = plot_.height + millimetres(5);
    const double width = canvas_.typesetter().width(title, style::kAxisPoints);
    return std::clamp(style::kAxisPoints * room / std::max(1.0, width), kLeast, style::kAxisPoints);
  }

  void annotate(const Annotation& annotation) {
    const double px = x(annotation.x);
    const double py = y(annotation.y);
    if (!drawable(px, py) || !grown(plot_, 2).contains(cv::Point(int(px), int(py)))) return;
    const double away = millimetres(1.9);
    Side side = annotation.side;
    const double width = canvas_.typesetter().width(annotation.text, style::kNotePoints);
    if (side == Side::right && px + away + width > plot_.br().x) side = Side::left;
    if (side == Side::left && px - away - width < plot_.x) side = Side::right;
    TextStyle style{style::kNotePoints, rgb(annotation.ink), AlignX::centre, AlignY::middle};
    style.halo = true;
    cv::Point2d at(px, py);
    switch (side) {
      case Side::left:
        at.x -= away;
        style.x = AlignX::right;
        break;
      case Side::right:
        at.x += away;
        style.x = AlignX::left;
        break;
      case Side::above:
        at.y -= away;
        style.y = AlignY::baseline;
        break;
      case Side::below:
        at.y += away;
        style.y = AlignY::top;
        break;
      case Side::centre:
        break;
    }
    canvas_.text(annotation.text, at, style);
  }

  /// The corner of the plot with the fewest data in an area of the given size.
  cv::Rect quietest_corner(int width, int height) const {
    const int margin = int(millimetres(4));
    const int left = plot_.x + margin;
    const int right = plot_.br().x - margin - width;
    const int top = plot_.y + margin;
    const int bottom = plot_.br().y - margin - height;
    cv::Rect best;
    size_t fewest = SIZE_MAX;
    for (const cv::Point corner : {cv::Point(right, bottom), cv::Point(left, bottom),
                                   cv::Point(right, top), cv::Point(left, top)}) {
      const cv::Rect area(corner, cv::Size(width, height));
      const size_t inside = points_inside(grown(area, millimetres(2)));
      if (inside < fewest) {
        fewest = inside;
        best = area;
      }
    }
    return best;
  }

  size_t points_inside(const cv::Rect& area) const {
    size_t count = 0;
    for (const Series& series : panel_.series) {
      for (size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
        const cv::Point2d p(x(series.x[i]), y(series.y[i]));
        if (drawable(p.x, p.y) && cv::Rect2d(area).contains(p)) ++count;
      }
    }
    return count;
  }

  void scale_bar() {
    const double per_pixel = placed_.x.span().width() / plot_.width;
    const double wanted = 0.2 * placed_.x.span().width();
    const double power = std::pow(10, std::floor(std::log10(wanted)));
    const double length = wanted >= 5 * power ? 5 * power : wanted >= 2 * power ? 2 * power : power;
    const double pixels = length / per_pixel;
    const cv::Rect area = quietest_corner(int(pixels), int(millimetres(7)));
    const double level = area.br().y - millimetres(1);
    const double cap = millimetres(1.1);
    canvas_.box(grown(area, millimetres(1.2)), {255, 255, 255}, 0.8);
    canvas_.polylines({{{double(area.x), level - cap},
                        {double(area.x), level},
                        {area.x + pixels, level},
                        {area.x + pixels, level - cap}}},
                      {style::kText, 1.4 * kPixelsPerPoint, 1, Dash::none}, plot_);
    const bool kilometres = panel_.x.unit == "m" && length >= 1000;
    const std::string text = significant_text(kilometres ? length / 1000 : length, 1) + " " +
                             (kilometres ? "km" : panel_.x.unit);
    canvas_.text(text, {area.x + pixels / 2, level - millimetres(2)},
                 {style::kNotePoints, style::kText, AlignX::centre, AlignY::baseline});
  }

  void colour_bar() {
    const int left = plot_.br().x + int(millimetres(4));
    const int width = int(style::kColourBar);
    for (int row = 0; row < plot_.height; ++row) {
      const double share = 1 - (row + 0.5) / plot_.height;
      canvas_.box({left, plot_.y + row, width, 1}, colormap(share));
    }
    const Ticks ticks = placed_.colour->ticks(std::max(2, int(plot_.height / millimetres(16))));
    for (const Tick& tick : ticks.ticks) {
      const double at = placed_.colour->pixel(tick.at);
      horizontal_rule(at, left + width, int(style::kTickLength), style::kSpineWidth, style::kSpine);
      canvas_.text(tick.label, {left + width + style::kTickLength + millimetres(0.9), at},
                   {style::kTickPoints, style::kSoftText, AlignX::left, AlignY::middle});
    }
    TextStyle style{style::kAxisPoints, style::kText, AlignX::centre, AlignY::baseline};
    style.upwards = true;
    canvas_.text(axis_title(panel_.colour, ticks),
                 {left + width + millimetres(15.5), plot_.y + plot_.height / 2.0}, style);
  }

  void head() {
    double level = plot_.y - style::kAboveData - millimetres(1);
    if (placed_.legend) {
      const double top = plot_.y - style::kAboveData - placed_.legend->height();
      placed_.legend->draw(canvas_, {double(plot_.x), top});
      level = top - millimetres(1);
    }
    TextStyle title{style::kAxisPoints, style::kText, AlignX::left, AlignY::baseline};
    title.bold = true;
    level -= style::kHeadLine * std::max(0.0, double(placed_.notes.size()) - 1);
    canvas_.text(panel_.title, {double(plot_.x), level}, title);
    for (const std::string& note : placed_.notes) {
      canvas_.text(note, {double(plot_.br().x), level},
                   {style::kNotePoints, style::kSoftText, AlignX::right, AlignY::baseline});
      level += style::kHeadLine;
    }
  }

  const PlacedPanel& placed_;
  const Panel& panel_;
  const cv::Rect plot_;
  Surface& canvas_;
};

}  // namespace

void paint_panel(const PlacedPanel& placed, Surface& canvas) {
  PanelPainter(placed, canvas).paint();
}

}  // namespace foucault::plot
