#pragma once

#include <string>
#include <vector>

#include "canvas.h"

namespace foucault::plot {

/// The same drawing as vectors, for papers: SVG in the pixels of a Canvas. Text stays text,
/// in DejaVu Sans or what the reader has.
class SvgCanvas : public Surface {
 public:
  SvgCanvas(cv::Size size, Typesetter& typesetter);

  void polylines(const std::vector<Polyline>& lines, const Pen& pen, const cv::Rect& clip) override;
  void polygons(const std::vector<Polyline>& polygons, Rgb colour, double opacity,
                const cv::Rect& clip) override;
  void markers(const Polyline& places, Shape shape, double diameter, Rgb colour, double opacity,
               const cv::Rect& clip) override;
  void box(const cv::Rect& area, Rgb colour, double opacity = 1) override;
  void text(const std::string& text, cv::Point2d at, const TextStyle& style) override;

  /// The whole file; a pixel is `scale` times as large on paper as that of a Canvas.
  std::string svg(double scale = 1) const;

 private:
  /// The reference to a clip path of this rectangle, which is defined once.
  std::string clipped_to(const cv::Rect& clip);
  void path(const std::string& data, const std::string& look, const cv::Rect& clip);

  cv::Size size_;
  std::vector<cv::Rect> clips_;
  std::string body_;
};

}  // namespace foucault::plot
