#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "foucault/plot/palette.h"
#include "foucault/plot/renderer.h"

namespace cv::freetype {
class FreeType2;
}

namespace foucault::plot {

constexpr double kPixelsPerMillimetre = 8;
constexpr double kPixelsPerPoint = kPixelsPerMillimetre * 25.4 / 72;

using Polyline = std::vector<cv::Point2d>;

struct Pen {
  Rgb colour;
  double width = 1;  ///< [px]
  double opacity = 1;
  bool dashed = false;
};

enum class AlignX { left, centre, right };
enum class AlignY { baseline, middle, top };

struct TextStyle {
  double points = 9;
  Rgb colour = {};
  AlignX x = AlignX::left;
  AlignY y = AlignY::baseline;
  bool bold = false;
  bool upwards = false;  ///< turned by 90 degrees, reading upwards; x, y refer to the turned text
  bool halo = false;     ///< a white seam that keeps it legible over data
};

/// Reads the fonts once; draws and measures text.
class Typesetter {
 public:
  /// Throws DataError if a font cannot be read.
  explicit Typesetter(const Fonts& fonts);

  /// Width of the text [px].
  double width(const std::string& text, double points, bool bold = false);

  /// Coverage of the text, 0..255; its baseline starts at `origin` in the image.
  struct Ink {
    cv::Mat coverage;
    cv::Point origin;
    int width = 0;
  };
  Ink set(const std::string& text, double points, bool bold);

 private:
  cv::freetype::FreeType2& font(bool bold) { return bold ? *bold_ : *regular_; }

  cv::Ptr<cv::freetype::FreeType2> regular_;
  cv::Ptr<cv::freetype::FreeType2> bold_;
};

/// An image one can draw on. Coordinates in pixels, x right, y down, fractions meaningful.
/// Everything is drawn as coverage at four times the resolution, averaged and blended, so edges are
/// smooth and a translucent shape has one even tone however it overlaps itself.
class Canvas {
 public:
  Canvas(cv::Size size, Typesetter& typesetter);

  const cv::Mat& image() const { return image_; }
  Typesetter& typesetter() { return typesetter_; }

  void polylines(const std::vector<Polyline>& lines, const Pen& pen, const cv::Rect& clip);
  void polygons(const std::vector<Polyline>& convex, Rgb colour, double opacity,
                const cv::Rect& clip);
  void markers(const Polyline& places, Shape shape, double diameter, Rgb colour, double opacity,
               const cv::Rect& clip);
  /// Triangles on a border, pointing up or down.
  void arrowheads(const Polyline& tips, bool up, double size, Rgb colour, const cv::Rect& clip);
  /// Whole pixels, crisp edges.
  void box(const cv::Rect& area, Rgb colour, double opacity = 1);
  void text(const std::string& text, cv::Point2d at, const TextStyle& style);

 private:
  /// Blends what `draw(mask)` draws, which is called for one part of the area after the other.
  template <class Draw>
  void cover(const cv::Rect& area, Rgb colour, double opacity, Draw draw);
  void blend(const cv::Mat& coverage, cv::Point top_left, Rgb colour, double opacity);

  cv::Mat image_;
  std::vector<uchar> scratch_;  // for the fine coverage; kept
  Typesetter& typesetter_;
};

}  // namespace foucault::plot
