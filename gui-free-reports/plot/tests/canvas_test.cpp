#include "canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

/// Shapes are drawn in bands of rows; nothing may show where one band meets the next.
namespace foucault::plot {
namespace {

constexpr Rgb kBlack{0, 0, 0};
const cv::Size kPage(400, 600);  // nine bands and a half
const cv::Rect kAll({}, kPage);

class OnPage : public testing::Test {
 protected:
  /// Blackness of each row [px].
  std::vector<double> ink_by_row() const {
    std::vector<double> rows;
    for (int y = 0; y < kPage.height; ++y) {
      rows.push_back(kPage.width - cv::sum(canvas_.image().row(y))[0] / 255);
    }
    return rows;
  }

  Typesetter typesetter_{find_fonts()};
  Canvas canvas_{kPage, typesetter_};
};

TEST_F(OnPage, ATriangleOverAllBandsGrowsLinearly) {
  canvas_.polygons({{{20, 0}, {20, 600}, {380, 600}}}, kBlack, 1, kAll);
  const std::vector<double> ink = ink_by_row();
  // An edge is a quarter of a pixel wide at worst, on both sides.
  for (int y = 0; y < kPage.height; ++y) EXPECT_NEAR(ink[size_t(y)], 0.6 * (y + 0.5), 0.6) << y;
}

TEST_F(OnPage, ASlantedLineIsAsWideInEveryRow) {
  const double width = 6;
  canvas_.polylines({{{50, -100}, {350, 700}}}, {kBlack, width, 1, Dash::none}, kAll);
  const double across = width * std::hypot(300, 800) / 800;
  for (const double ink : ink_by_row()) EXPECT_NEAR(ink, across, 0.6);
}

TEST_F(OnPage, MarkersLookTheSameOnASeam) {
  for (const Shape shape : {Shape::dot, Shape::ring, Shape::cross, Shape::plus, Shape::triangle,
                            Shape::square, Shape::diamond, Shape::star, Shape::tick}) {
    Canvas canvas(kPage, typesetter_);
    // Bands begin 25 above the first, at 7: the second and the fourth lie on seams at 71, 135.
    canvas.markers({{50, 32}, {150, 64}, {250, 96}, {350, 128}}, shape, 24, kBlack, 1, kAll);
    const auto look = [&](int x, int y) {
      return canvas.image()(cv::Rect(x - 20, y - 20, 40, 40)).clone();
    };
    const cv::Mat first = look(50, 32);
    ASSERT_GT(cv::sum(255 - first)[0], 0);
    for (const auto& [x, y] : {std::pair{150, 64}, std::pair{250, 96}, std::pair{350, 128}}) {
      // Fine lines may fall on the neighbouring quarter of a pixel.
      EXPECT_LE(cv::norm(look(x, y), first, cv::NORM_INF), 70) << int(shape) << " at " << y;
      EXPECT_NEAR(cv::sum(255 - look(x, y))[0], cv::sum(255 - first)[0],
                  0.02 * cv::sum(255 - first)[0])
          << int(shape) << " at " << y;
    }
  }
}

}  // namespace
}  // namespace foucault::plot
