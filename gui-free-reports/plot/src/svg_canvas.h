#pragma once

#include <string>
#include <vector>

#include "canvas.h"

namespace foucault::plot {

/// The same drawing as vectors, for papers: SVG in the pixels of a Canvas, as wide on paper as the
/// figure says. Text stays text, in DejaVu Sans or what the reader has.
class SvgCanvas : public Surface {
 public:
  SvgCanvas(cv::Size size, Typesetter& typesetter);

  void polylines(const std::vector<Polyline>& lines, const Pen& pen, const cv::Rect& clip) override;
  void polygons(const std::vector<Polyline>& convex, Rgb colour, double opacity,
                const cv::Rect& clip) override;
  void markers(const Polyline& places, Shape shape, double diameter, Rgb colour, double opacity,
               const cv::Rect& clip) override;
  void box(const cv::Rect& area, Rgb colour, double opacity = 1) override;
  void text(const std::string& text, cv::Point2d at, const TextStyle& style) override;

  /// The whole file.
  std::string svg() const;

 private:
  /// The reference to a clip path of this rectangle, which is defined once.
  std::string clipped_to(const cv::Rect& clip);
  void path(const std::string& data, const std::string& look, const cv::Rect& clip);

  cv::Size size_;
  std::vector<cv::Rect> clips_;
  std::string body_;
};

}  // namespace foucault::plot
