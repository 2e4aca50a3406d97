#include "svg_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace foucault::plot {
namespace {

constexpr double kSeen = 0.5;    // [px]: shorter steps of a line are not seen
constexpr double kFarOut = 1e5;  // [px]: numbers stay short

std::string hex(Rgb c) { return fmt::format("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue); }

std::string point(char command, const cv::Point2d& p) {
  return fmt::format("{}{:.1f} {:.1f}", command, std::clamp(p.x, -kFarOut, kFarOut),
                     std::clamp(p.y, -kFarOut, kFarOut));
}

std::string corners(const Polyline& polygon) {
  std::string data;
  for (const cv::Point2d& p : polygon) data += point(data.empty() ? 'M' : 'L', p);
  return data + "Z";
}

/// Without the points that are too close to the one before; the last one stays.
std::string open_line(const Polyline& line) {
  if (line.empty()) return {};
  std::string data = point('M', line.front());
  cv::Point2d last = line.front();
  for (size_t i = 1; i < line.size(); ++i) {
    if (i + 1 < line.size() && cv::norm(line[i] - last) < kSeen) continue;
    data += point('L', line[i]);
    last = line[i];
  }
  return data;
}

std::string circle(const cv::Point2d& p, double r) {
  return fmt::format("M{:.1f} {:.1f}a{:.1f} {:.1f} 0 1 0 {:.1f} 0a{:.1f} {:.1f} 0 1 0 {:.1f} 0Z",
                     p.x - r, p.y, r, r, 2 * r, r, r, -2 * r);
}

std::string stroke(const cv::Point2d& p, double dx, double dy) {
  return point('M', {p.x - dx, p.y - dy}) + point('L', {p.x + dx, p.y + dy});
}

std::string star_path(const cv::Point2d& p, double radius) {
  Polyline points;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 == 0 ? radius : 0.45 * radius;
    const double angle = -CV_PI / 2 + i * CV_PI / 5;
    points.emplace_back(p.x + r * std::cos(angle), p.y + r * std::sin(angle));
  }
  return corners(points);
}

bool is_stroked(Shape shape) {
  return shape == Shape::ring || shape == Shape::cross || shape == Shape::plus ||
         shape == Shape::tick || shape == Shape::frame;
}

std::string marker_path(Shape shape, const cv::Point2d& p, double r) {
  switch (shape) {
    case Shape::dot:
    case Shape::ring:
      return circle(p, r);
    case Shape::cross:
      return stroke(p, 0.85 * r, 0.85 * r) + stroke(p, 0.85 * r, -0.85 * r);
    case Shape::plus:
      return stroke(p, r, 0) + stroke(p, 0, r);
    case Shape::triangle:
      return corners({{p.x, p.y - r}, {p.x + r, p.y + 0.8 * r}, {p.x - r, p.y + 0.8 * r}});
    case Shape::square:
    case Shape::frame:
      return corners(
          {{p.x - r, p.y - r}, {p.x + r, p.y - r}, {p.x + r, p.y + r}, {p.x - r, p.y + r}});
    case Shape::diamond:
      return corners({{p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r}, {p.x - r, p.y}});
    case Shape::star:
      return star_path(p, 1.2 * r);
    case Shape::tick:
      return stroke(p, 0, r);
  }
  return {};
}

std::string escaped_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

const char* anchor(AlignX align) {
  return align == AlignX::left ? "start" : align == AlignX::centre ? "middle" : "end";
}

std::string dash_array(const Pen& pen) {
  std::string numbers;
  for (const double part : dash_pattern(pen.dash)) {
    numbers += fmt::format("{}{:.1f}", numbers.empty() ? "" : " ", part * pen.width);
  }
  return numbers.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", numbers);
}

}  // namespace

SvgCanvas::SvgCanvas(cv::Size size, Typesetter& typesetter) : Surface(typesetter), size_(size) {}

std::string SvgCanvas::clipped_to(const cv::Rect& clip) {
  auto found = std::find(clips_.begin(), clips_.end(), clip);
  if (found == clips_.end()) found = clips_.insert(clips_.end(), clip);
  return fmt::format(" clip-path=\"url(#c{})\"", found - clips_.begin());
}

void SvgCanvas::path(const std::string& data, const std::string& look, const cv::Rect& clip) {
  if (data.empty()) return;
  body_ += fmt::format("<path d=\"{}\" {}{}/>\n", data, look, clipped_to(clip));
}

void SvgCanvas::polylines(const std::vector<Polyline>& lines, const Pen& pen,
                          const cv::Rect& clip) {
  std::string data;
  for (const Polyline& line : lines) data += open_line(line);
  path(data,
       fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{:.1f}\" stroke-opacity=\"{:.2f}\" "
                   "stroke-linejoin=\"round\"{}",
                   hex(pen.colour), pen.width, pen.opacity, dash_array(pen)),
       clip);
}

void SvgCanvas::polygons(const std::vector<Polyline>& polygons, Rgb colour, double opacity,
                         const cv::Rect& clip) {
  std::string data;
  for (const Polyline& polygon : polygons) data += corners(polygon);
  path(data, fmt::format("fill=\"{}\" fill-opacity=\"{:.2f}\"", hex(colour), opacity), clip);
}

void SvgCanvas::markers(const Polyline& places, Shape shape, double diameter, Rgb colour,
                        double opacity, const cv::Rect& clip) {
  std::string data;
  for (const cv::Point2d& place : places) data += marker_path(shape, place, diameter / 2);
  const double width = shape == Shape::tick ? 1.8 : std::max(1.5, 0.24 * diameter);
  path(data,
       is_stroked(shape)
           ? fmt::format(
                 "fill=\"none\" stroke=\"{}\" stroke-width=\"{:.1f}\" stroke-opacity=\"{:.2f}\"",
                 hex(colour), width, opacity)
           : fmt::format("fill=\"{}\" fill-opacity=\"{:.2f}\"", hex(colour), opacity),
       clip);
}

void SvgCanvas::box(const cv::Rect& area, Rgb colour, double opacity) {
  body_ += fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" fill-opacity=\"{:.2f}\"/>\n",
      area.x, area.y, area.width, area.height, hex(colour), opacity);
}

void SvgCanvas::text(const std::string& text, cv::Point2d at, const TextStyle& style) {
  if (text.empty()) return;
  const double size = style.points * kPixelsPerPoint;
  const double cap = kCapHeight * size;
  const double down = style.y == AlignY::baseline ? 0 : style.y == AlignY::middle ? cap / 2 : cap;
  const std::string turn = style.upwards ? " rotate(-90)" : "";
  const std::string halo =
      style.halo ? " stroke=\"#fff\" stroke-width=\"6\" paint-order=\"stroke\"" : "";
  body_ += fmt::format(
      "<text transform=\"translate({:.1f} {:.1f}){}\" y=\"{:.1f}\" font-size=\"{:.1f}\" "
      "fill=\"{}\" text-anchor=\"{}\"{}{}>{}</text>\n",
      at.x, at.y, turn, down, size, hex(style.colour), anchor(style.x),
      style.bold ? " font-weight=\"bold\"" : "", halo, escaped_text(text));
}

std::string SvgCanvas::svg(double scale) const {
  std::string file = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.1f}mm\" height=\"{:.1f}mm\" "
      "viewBox=\"0 0 {} {}\" font-family=\"DejaVu Sans, sans-serif\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<defs>\n",
      scale * size_.width / kPixelsPerMillimetre, scale * size_.height / kPixelsPerMillimetre,
      size_.width, size_.height);
  for (size_t i = 0; i < clips_.size(); ++i) {
    const cv::Rect& c = clips_[i];
    file += fmt::format(
        "<clipPath id=\"c{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", i,
        c.x, c.y, c.width, c.height);
  }
  return file + "</defs>\n" + body_ + "</svg>\n";
}

}  // namespace foucault::plot
