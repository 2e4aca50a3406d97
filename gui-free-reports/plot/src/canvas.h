#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "foucault/plot/figure.h"
#include "foucault/plot/palette.h"
#include "foucault/plot/renderer.h"

namespace cv::freetype {
class FreeType2;
}

namespace foucault::plot {

constexpr double kPixelsPerMillimetre = 8;
constexpr double kCapHeight = 0.73;  // of DejaVu Sans, in em
constexpr double kPixelsPerPoint = kPixelsPerMillimetre * 25.4 / 72;

using Polyline = std::vector<cv::Point2d>;

struct Pen {
  Rgb colour;
  double width = 1;  ///< [px]
  double opacity = 1;
  Dash dash = Dash::none;
};

/// Lengths of strokes and gaps, by turns, in widths of the line; empty: unbroken.
std::vector<double> dash_pattern(Dash dash);

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

/// Reads the fonts once; draws and measures text. What was set stays: labels of axes come again and
/// again.
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
  const Ink& set(const std::string& text, double points, bool bold);

 private:
  using Key = std::tuple<std::string, int, bool>;  ///< text, size [px], bold

  cv::freetype::FreeType2& font(bool bold) { return bold ? *bold_ : *regular_; }

  cv::Ptr<cv::freetype::FreeType2> regular_;
  cv::Ptr<cv::freetype::FreeType2> bold_;
  std::map<Key, double> widths_;
  std::map<Key, Ink> inks_;
};

/// What one can draw on. Coordinates in pixels, x right, y down, fractions meaningful.
class Surface {
 public:
  explicit Surface(Typesetter& typesetter) : typesetter_(typesetter) {}
  virtual ~Surface() = default;
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  Typesetter& typesetter() { return typesetter_; }

  virtual void polylines(const std::vector<Polyline>& lines, const Pen& pen,
                         const cv::Rect& clip) = 0;
  virtual void polygons(const std::vector<Polyline>& polygons, Rgb colour, double opacity,
                        const cv::Rect& clip) = 0;
  virtual void markers(const Polyline& places, Shape shape, double diameter, Rgb colour,
                       double opacity, const cv::Rect& clip) = 0;
  /// Whole pixels, crisp edges.
  virtual void box(const cv::Rect& area, Rgb colour, double opacity = 1) = 0;
  virtual void text(const std::string& text, cv::Point2d at, const TextStyle& style) = 0;

  /// Triangles on a border, pointing up or down.
  void arrowheads(const Polyline& tips, bool up, double size, Rgb colour, const cv::Rect& clip);

 protected:
  Typesetter& typesetter_;
};

/// An image. Everything is drawn as coverage at four times the resolution, averaged and blended, so
/// edges are smooth and a translucent shape has one even tone however it overlaps itself.
class Canvas : public Surface {
 public:
  Canvas(cv::Size size, Typesetter& typesetter);

  /// A new white page; the memory is that of the last one.
  void clear(cv::Size size);

  const cv::Mat& image() const { return image_; }
  void polylines(const std::vector<Polyline>& lines, const Pen& pen, const cv::Rect& clip) override;
  void polygons(const std::vector<Polyline>& polygons, Rgb colour, double opacity,
                const cv::Rect& clip) override;
  void markers(const Polyline& places, Shape shape, double diameter, Rgb colour, double opacity,
               const cv::Rect& clip) override;
  void box(const cv::Rect& area, Rgb colour, double opacity = 1) override;
  void text(const std::string& text, cv::Point2d at, const TextStyle& style) override;

 private:
  /// Blends what `draw(mask)` draws, which is called for one part of the area after the other.
  template <class Draw>
  void cover(const cv::Rect& area, Rgb colour, double opacity, Draw draw);
  void blend(const cv::Mat& coverage, cv::Point top_left, Rgb colour, double opacity);

  std::vector<uchar> pixels_;
  cv::Mat image_;               // of them
  std::vector<uchar> scratch_;  // for the fine coverage; kept
};

}  // namespace foucault::plot
