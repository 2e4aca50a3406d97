#pragma once

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "foucault/plot/renderer.h"

/// Figures as images, and what ink is where.
namespace foucault::plot {

inline cv::Mat draw(const Figure& figure) {
  Renderer renderer;
  return cv::imdecode(renderer.png(figure), cv::IMREAD_COLOR);
}

inline bool is_near(const cv::Vec3b& pixel, Ink ink) {
  const Rgb colour = rgb(ink);
  return std::abs(pixel[0] - colour.blue) + std::abs(pixel[1] - colour.green) +
             std::abs(pixel[2] - colour.red) <
         30;
}

/// Pixels of a colour in a part of the image, given in shares of its sides.
inline int ink_in(const cv::Mat& image, Ink ink, cv::Rect2d shares) {
  int count = 0;
  for (int y = int(shares.y * image.rows); y < int(shares.br().y * image.rows); ++y) {
    for (int x = int(shares.x * image.cols); x < int(shares.br().x * image.cols); ++x) {
      count += is_near(image.at<cv::Vec3b>(y, x), ink) ? 1 : 0;
    }
  }
  return count;
}

const cv::Rect2d kInside(0.15, 0.3, 0.8, 0.5);

inline Figure curve(const std::vector<double>& x, const std::vector<double>& y) {
  Figure figure;
  figure.name = "curve";
  figure.title = "A curve";
  figure.width_mm = 120;
  figure.height_mm = 80;
  figure.panels.resize(1);
  Series series;
  series.label = "curve";
  series.in_legend = false;
  series.x = x;
  series.y = y;
  figure.panels[0].x.label = "x";
  figure.panels[0].y.label = "y";
  figure.panels[0].series.push_back(series);
  return figure;
}

}  // namespace foucault::plot
