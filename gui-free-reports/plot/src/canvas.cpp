#include "canvas.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/freetype.hpp>
#include <opencv2/imgproc.hpp>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

constexpr int kFine = 4;        // fine pixels a pixel, each way
constexpr int kShift = 4;       // fractional bits of fine coordinates
constexpr int kBand = 64;       // height of the fine mask [px]: 2 MB, within reach of a cache
constexpr double kMargin = 64;  // lines are cut this far outside of what is seen [px]
constexpr double kFar = 8192;   // corners are moved this close [px], for whole numbers

int pixels(double points) { return static_cast<int>(std::lround(points * kPixelsPerPoint)); }

cv::Scalar scalar(Rgb c) { return {double(c.blue), double(c.green), double(c.red)}; }

/// Eight bytes are zero.
bool is_blank(const uchar* coverage) {
  uint64_t eight = 0;
  std::memcpy(&eight, coverage, sizeof(eight));
  return eight == 0;
}

cv::Range operator*(int factor, const cv::Range& range) {
  return {factor * range.start, factor * range.end};
}

cv::Rect bounds(const std::vector<Polyline>& lines, double margin, const cv::Rect& clip) {
  double left = clip.br().x, top = clip.br().y, right = clip.x, bottom = clip.y;
  for (const Polyline& line : lines) {
    for (const cv::Point2d& p : line) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  left = std::max(left - margin, double(clip.x));
  top = std::max(top - margin, double(clip.y));
  right = std::min(right + margin, double(clip.br().x));
  bottom = std::min(bottom + margin, double(clip.br().y));
  if (right <= left || bottom <= top) return {};
  const cv::Point first(int(std::floor(left)), int(std::floor(top)));
  return cv::Rect(first, cv::Point(int(std::ceil(right)), int(std::ceil(bottom))));
}

/// The part of a polygon on one side of a level, where `inside` is zero or above.
template <class Inside>
Polyline cut_off(const Polyline& polygon, Inside inside) {
  Polyline part;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d& from = polygon[i];
    const cv::Point2d& to = polygon[(i + 1) % polygon.size()];
    const double begin = inside(from);
    const double end = inside(to);
    if (begin >= 0) part.push_back(from);
    if ((begin >= 0) != (end >= 0)) part.push_back(from + (to - from) * (begin / (begin - end)));
  }
  return part;
}

Polyline between_levels(const Polyline& polygon, double top, double bottom) {
  return cut_off(cut_off(polygon, [top](const cv::Point2d& p) { return p.y - top; }),
                 [bottom](const cv::Point2d& p) { return bottom - p.y; });
}

/// Coverage of a part of the image at four times its resolution.
class FineMask {
 public:
  /// `scratch` holds the pixels while the mask lives, and zeros before and after.
  FineMask(const cv::Rect& area, std::vector<uchar>& scratch) : area_(area) {
    const cv::Size size(area.width * kFine, area.height * kFine);
    if (scratch.size() < static_cast<size_t>(size.area())) scratch.resize(size_t(size.area()));
    fine_ = cv::Mat(size, CV_8UC1, scratch.data());
  }
  ~FineMask() { fine_.rowRange(kFine * rows()).setTo(0); }
  FineMask(const FineMask&) = delete;
  FineMask& operator=(const FineMask&) = delete;

  /// Of the area, those in which something was drawn.
  cv::Range rows() const { return first_ < last_ ? cv::Range(first_, last_) : cv::Range(0, 0); }

  void line(const cv::Point2d& a, const cv::Point2d& b, double width) {
    cv::Point2d p = a;
    cv::Point2d q = b;
    if (!cut(p, q)) return;
    touch(std::min(p.y, q.y) - width, std::max(p.y, q.y) + width);
    const int thickness = std::max(1, int(std::lround(width * kFine)));
    cv::line(fine_, fixed(p), fixed(q), kOn, thickness, cv::LINE_8, kShift);
  }

  void disc(const cv::Point2d& centre, double radius, double ring_width = 0) {
    if (misses(centre.y - radius - ring_width, centre.y + radius + ring_width)) return;
    touch(centre.y - radius - ring_width, centre.y + radius + ring_width);
    const int fixed_radius = int(std::lround(radius * kFine * (1 << kShift)));
    const int thickness = ring_width > 0 ? int(std::lround(ring_width * kFine)) : cv::FILLED;
    cv::circle(fine_, fixed(centre), fixed_radius, kOn, thickness, cv::LINE_8, kShift);
  }

  void convex(const Polyline& corners) {
    const auto by_height = [](const cv::Point2d& a, const cv::Point2d& b) { return a.y < b.y; };
    const auto [top, bottom] = std::minmax_element(corners.begin(), corners.end(), by_height);
    if (misses(top->y, bottom->y)) return;
    touch(top->y, bottom->y);
    std::vector<cv::Point> points;
    points.reserve(corners.size());
    for (const cv::Point2d& corner : corners) points.push_back(fixed(clamped(corner)));
    cv::fillConvexPoly(fine_, points, kOn, cv::LINE_8, kShift);
  }

  /// Need not be convex.
  void polygon(const Polyline& corners) {
    const Polyline part = between_levels(corners, area_.y - 1, area_.br().y + 1);
    if (part.empty()) return;
    std::vector<cv::Point> points;
    points.reserve(part.size());
    for (const cv::Point2d& corner : part) {
      points.push_back(fixed(clamped(corner)));
      touch(corner.y, corner.y);
    }
    const cv::Point* begin = points.data();
    const int size = int(points.size());
    cv::fillPoly(fine_, &begin, &size, 1, kOn, cv::LINE_8, kShift);
  }

  /// Of these rows.
  cv::Mat coverage() const {
    cv::Mat half, whole;
    cv::resize(fine_.rowRange(kFine * rows()), half, {}, 0.5, 0.5, cv::INTER_AREA);
    cv::resize(half, whole, {}, 0.5, 0.5, cv::INTER_AREA);
    return whole;
  }

 private:
  static inline const cv::Scalar kOn = cv::Scalar::all(255);

  /// Fine pixel centres lie at half-integers of the continuous plane.
  cv::Point fixed(const cv::Point2d& p) const {
    const double scale = 1 << kShift;
    return {int(std::lround(((p.x - area_.x) * kFine - 0.5) * scale)),
            int(std::lround(((p.y - area_.y) * kFine - 0.5) * scale))};
  }

  cv::Point2d clamped(const cv::Point2d& p) const {
    return {std::clamp(p.x, area_.x - kFar, area_.br().x + kFar),
            std::clamp(p.y, area_.y - kFar, area_.br().y + kFar)};
  }

  /// Something is drawn between these heights; edges reach a fine pixel further.
  void touch(double top, double bottom) {
    const auto row = [&](double y) {
      return int(std::clamp(std::floor(y - area_.y), -1.0, double(area_.height)));
    };
    first_ = std::min(first_, std::max(0, row(top - 1)));
    last_ = std::max(last_, std::min(area_.height, row(bottom + 1) + 1));
  }

  /// Nothing of what lies between these heights is in the area.
  bool misses(double top, double bottom) const {
    return bottom < area_.y - 1 || top > area_.br().y + 1;
  }

  /// Cuts the segment to the neighbourhood of the area (Liang and Barsky); false if none is left.
  bool cut(cv::Point2d& a, cv::Point2d& b) const {
    const cv::Point2d d = b - a;
    double enter = 0;
    double leave = 1;
    const auto against = [&](double speed, double room) {
      if (speed == 0) return room >= 0;
      const double t = room / speed;
      if (speed < 0) enter = std::max(enter, t);
      if (speed > 0) leave = std::min(leave, t);
      return enter <= leave;
    };
    if (!against(-d.x, a.x - (area_.x - kMargin)) || !against(d.x, area_.br().x + kMargin - a.x) ||
        !against(-d.y, a.y - (area_.y - kMargin)) || !against(d.y, area_.br().y + kMargin - a.y)) {
      return false;
    }
    const cv::Point2d start = a;
    a = start + d * enter;
    b = start + d * leave;
    return true;
  }

  cv::Rect area_;
  cv::Mat fine_;
  int first_ = INT_MAX;  ///< row of the area; what was drawn ends before `last_`
  int last_ = 0;
};

std::vector<Polyline> dashes(const Polyline& line, const std::vector<double>& pattern) {
  std::vector<Polyline> result;
  size_t part = 0;
  double left = pattern[0];
  bool drawing = true;
  Polyline current;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    cv::Point2d at = line[i];
    if (drawing && current.empty()) current.push_back(at);
    double length = cv::norm(line[i + 1] - at);
    while (length > left) {
      at += (line[i + 1] - at) * (left / length);
      length -= left;
      if (drawing) {
        current.push_back(at);
        result.push_back(current);
        current.clear();
      } else {
        current = {at};
      }
      drawing = !drawing;
      part = (part + 1) % pattern.size();
      left = pattern[part];
    }
    left -= length;
    if (drawing) current.push_back(line[i + 1]);
  }
  if (drawing && current.size() > 1) result.push_back(current);
  return result;
}

std::vector<Polyline> dashes(const std::vector<Polyline>& lines, const Pen& pen) {
  std::vector<double> pattern = dash_pattern(pen.dash);
  for (double& length : pattern) length *= pen.width;
  std::vector<Polyline> result;
  for (const Polyline& line : lines) {
    for (Polyline& dash : dashes(line, pattern)) result.push_back(std::move(dash));
  }
  return result;
}

Polyline star(const cv::Point2d& centre, double radius) {
  Polyline corners;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? radius : 0.45 * radius;
    const double angle = -CV_PI / 2 + i * CV_PI / 5;
    corners.emplace_back(centre.x + r * std::cos(angle), centre.y + r * std::sin(angle));
  }
  return corners;
}

void add_cross(FineMask& mask, const cv::Point2d& p, double r, double width) {
  mask.line({p.x - r, p.y - r}, {p.x + r, p.y + r}, width);
  mask.line({p.x - r, p.y + r}, {p.x + r, p.y - r}, width);
}

void add_plus(FineMask& mask, const cv::Point2d& p, double r, double width) {
  mask.line({p.x - r, p.y}, {p.x + r, p.y}, width);
  mask.line({p.x, p.y - r}, {p.x, p.y + r}, width);
}

void add_frame(FineMask& mask, const cv::Point2d& p, double r, double width) {
  const Polyline corners{
      {p.x - r, p.y - r}, {p.x + r, p.y - r}, {p.x + r, p.y + r}, {p.x - r, p.y + r}};
  for (size_t i = 0; i < 4; ++i) mask.line(corners[i], corners[(i + 1) % 4], width);
}

void add_star(FineMask& mask, const cv::Point2d& p, double r) {
  const Polyline corners = star(p, r);
  for (size_t i = 0; i < corners.size(); ++i) {
    mask.convex({p, corners[i], corners[(i + 1) % corners.size()]});
  }
}

void add_marker(FineMask& mask, Shape shape, const cv::Point2d& p, double diameter) {
  const double r = diameter / 2;
  const double stroke = std::max(1.5, 0.24 * diameter);
  switch (shape) {
    case Shape::dot:
      return mask.disc(p, r);
    case Shape::ring:
      return mask.disc(p, r, stroke);
    case Shape::cross:
      return add_cross(mask, p, r * 0.85, stroke);
    case Shape::plus:
      return add_plus(mask, p, r, stroke);
    case Shape::triangle:
      return mask.convex({{p.x, p.y - r}, {p.x + r, p.y + 0.8 * r}, {p.x - r, p.y + 0.8 * r}});
    case Shape::square:
      return mask.convex(
          {{p.x - r, p.y - r}, {p.x + r, p.y - r}, {p.x + r, p.y + r}, {p.x - r, p.y + r}});
    case Shape::diamond:
      return mask.convex({{p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r}, {p.x - r, p.y}});
    case Shape::star:
      return add_star(mask, p, 1.2 * r);
    case Shape::frame:
      return add_frame(mask, p, r, stroke);
    case Shape::tick:
      return mask.convex(
          {{p.x - 0.9, p.y - r}, {p.x + 0.9, p.y - r}, {p.x + 0.9, p.y + r}, {p.x - 0.9, p.y + r}});
  }
}

cv::Ptr<cv::freetype::FreeType2> load_font(const std::string& path) {
  const cv::Ptr<cv::freetype::FreeType2> font = cv::freetype::createFreeType2();
  try {
    font->loadFontData(path, 0);
  } catch (const cv::Exception&) {
    throw DataError(path + ": not a font that can be read; set FOUCAULT_FONT to a .ttf file");
  }
  return font;
}

cv::Mat dilated(const cv::Mat& coverage, int radius) {
  cv::Mat wide;
  const cv::Mat disc =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
  cv::dilate(coverage, wide, disc);
  return wide;
}

}  // namespace

std::vector<double> dash_pattern(Dash dash) {
  switch (dash) {
    case Dash::none:
      break;
    case Dash::dashes:
      return {4.5, 3};
    case Dash::long_dashes:
      return {10, 3};
    case Dash::dots:
      return {1.2, 2};
    case Dash::dash_dot:
      return {6, 2.2, 1.2, 2.2};
  }
  return {};
}

Typesetter::Typesetter(const Fonts& fonts)
    : regular_(load_font(fonts.regular)), bold_(load_font(fonts.bold)) {}

double Typesetter::width(const std::string& text, double points, bool bold) {
  if (text.empty()) return 0;
  const auto [known, is_new] = widths_.try_emplace({text, pixels(points), bold});
  int baseline = 0;
  if (is_new) {
    known->second = font(bold).getTextSize(text, pixels(points), -1, &baseline).width;
  }
  return known->second;
}

const Typesetter::Ink& Typesetter::set(const std::string& text, double points, bool bold) {
  const int em = pixels(points);
  const auto [known, is_new] = inks_.try_emplace({text, em, bold});
  Ink& ink = known->second;
  if (!is_new) return ink;
  ink.width = int(std::lround(width(text, points, bold)));
  ink.origin = {em, em + em / 2};
  cv::Mat paper(2 * em + em / 4, ink.width + 2 * em, CV_8UC3, cv::Scalar::all(255));
  font(bold).putText(paper, text, ink.origin, em, cv::Scalar::all(0), -1, cv::LINE_AA, true);
  cv::extractChannel(paper, ink.coverage, 0);
  cv::bitwise_not(ink.coverage, ink.coverage);
  return ink;
}

Canvas::Canvas(cv::Size size, Typesetter& typesetter) : Surface(typesetter) { clear(size); }

void Canvas::clear(cv::Size size) {
  constexpr uchar kWhite = 255;
  pixels_.assign(3 * size_t(size.area()), kWhite);
  image_ = cv::Mat(size, CV_8UC3, pixels_.data());
}

/// In bands: a mask of the whole area would take sixteen times its pixels.
template <class Draw>
void Canvas::cover(const cv::Rect& area, Rgb colour, double opacity, Draw draw) {
  for (int top = area.y; top < area.br().y; top += kBand) {
    const cv::Rect band(area.x, top, area.width, std::min(kBand, area.br().y - top));
    FineMask mask(band, scratch_);
    draw(mask);
    if (mask.rows().empty()) continue;
    blend(mask.coverage(), {band.x, band.y + mask.rows().start}, colour, opacity);
  }
}

void Canvas::polylines(const std::vector<Polyline>& lines, const Pen& pen, const cv::Rect& clip) {
  const cv::Rect area = bounds(lines, pen.width + 1, clip);
  if (area.empty()) return;
  const std::vector<Polyline> dashed =
      pen.dash == Dash::none ? std::vector<Polyline>() : dashes(lines, pen);
  const std::vector<Polyline>& parts = pen.dash == Dash::none ? lines : dashed;
  cover(area, pen.colour, pen.opacity, [&](FineMask& mask) {
    for (const Polyline& part : parts) {
      for (size_t i = 0; i + 1 < part.size(); ++i) mask.line(part[i], part[i + 1], pen.width);
    }
  });
}

void Canvas::polygons(const std::vector<Polyline>& polygons, Rgb colour, double opacity,
                      const cv::Rect& clip) {
  const cv::Rect area = bounds(polygons, 1, clip);
  if (area.empty()) return;
  cover(area, colour, opacity, [&](FineMask& mask) {
    for (const Polyline& polygon : polygons) mask.polygon(polygon);
  });
}

void Canvas::markers(const Polyline& places, Shape shape, double diameter, Rgb colour,
                     double opacity, const cv::Rect& clip) {
  const cv::Rect area = bounds({places}, diameter + 1, clip);
  if (area.empty()) return;
  cover(area, colour, opacity, [&](FineMask& mask) {
    for (const cv::Point2d& place : places) add_marker(mask, shape, place, diameter);
  });
}

void Surface::arrowheads(const Polyline& tips, bool up, double size, Rgb colour,
                         const cv::Rect& clip) {
  std::vector<Polyline> triangles;
  const double base = up ? size : -size;
  for (const cv::Point2d& tip : tips) {
    triangles.push_back(
        {tip, {tip.x + 0.45 * size, tip.y + base}, {tip.x - 0.45 * size, tip.y + base}});
  }
  polygons(triangles, colour, 1, clip);
}

void Canvas::box(const cv::Rect& area, Rgb colour, double opacity) {
  const cv::Rect inside = area & cv::Rect({}, image_.size());
  if (inside.empty()) return;
  blend(cv::Mat(inside.size(), CV_8UC1, cv::Scalar::all(255)), inside.tl(), colour, opacity);
}

void Canvas::text(const std::string& text, cv::Point2d at, const TextStyle& style) {
  if (text.empty()) return;
  const Typesetter::Ink& ink = typesetter_.set(text, style.points, style.bold);
  cv::Mat coverage = ink.coverage;
  const double cap = kCapHeight * pixels(style.points);
  const double along = style.x == AlignX::left     ? 0
                       : style.x == AlignX::centre ? 0.5 * ink.width
                                                   : ink.width;
  const double above_baseline = style.y == AlignY::baseline ? 0
                                : style.y == AlignY::middle ? cap / 2
                                                            : cap;
  cv::Point2d anchor(ink.origin.x + along, ink.origin.y - above_baseline);
  if (style.upwards) {
    anchor = {anchor.y, ink.coverage.cols - 1 - anchor.x};
    coverage = cv::Mat();
    cv::rotate(ink.coverage, coverage, cv::ROTATE_90_COUNTERCLOCKWISE);
  }
  const cv::Point top_left(int(std::lround(at.x - anchor.x)), int(std::lround(at.y - anchor.y)));
  if (style.halo) blend(dilated(coverage, 4), top_left, {255, 255, 255}, 0.9);
  blend(coverage, top_left, style.colour, 1);
}

void Canvas::blend(const cv::Mat& coverage, cv::Point top_left, Rgb colour, double opacity) {
  const cv::Rect target = cv::Rect(top_left, coverage.size()) & cv::Rect({}, image_.size());
  if (target.empty()) return;
  const cv::Scalar ink = scalar(colour);
  const int share = int(std::lround(256 * std::clamp(opacity, 0.0, 1.0)));
  for (int y = 0; y < target.height; ++y) {
    const uchar* alpha = coverage.ptr(target.y + y - top_left.y) + (target.x - top_left.x);
    cv::Vec3b* pixel = image_.ptr<cv::Vec3b>(target.y + y) + target.x;
    for (int x = 0; x < target.width; ++x) {
      while (x + 8 <= target.width && is_blank(alpha + x)) x += 8;
      if (x == target.width) break;
      const int a = alpha[x] * share;
      if (a == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const int difference = int(ink[c]) - pixel[x][c];
        pixel[x][c] = uchar(pixel[x][c] + (difference * a) / (255 * 256));
      }
    }
  }
}

}  // namespace foucault::plot
