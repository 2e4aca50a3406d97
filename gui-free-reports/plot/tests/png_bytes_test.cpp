#include "png_bytes.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

/// Read back by another library.
namespace foucault::plot {
namespace {

constexpr size_t kKindOfColour = 25;  // its byte in the file

cv::Mat read_back(const std::vector<unsigned char>& png) {
  return cv::imdecode(png, cv::IMREAD_COLOR);
}

/// A line of every shade of one colour on white, `shades` of them.
cv::Mat shaded(int shades) {
  cv::Mat image(40, 300, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < shades; ++i) {
    image.at<cv::Vec3b>(i / 250, i % 250) = {uchar(i % 256), uchar(i / 2 % 256), 40};
  }
  return image;
}

TEST(PngBytes, FewColoursArePutInAPaletteAndComeBackAsTheyAre) {
  const cv::Mat image = shaded(200);
  const std::vector<unsigned char> png = to_png(image);
  EXPECT_EQ(png[kKindOfColour], 3);
  EXPECT_EQ(cv::norm(read_back(png), image, cv::NORM_INF), 0);
}

TEST(PngBytes, ColoursThatAreHardlyDifferentShareAPlace) {
  const cv::Mat image = shaded(600);
  const std::vector<unsigned char> png = to_png(image);
  EXPECT_EQ(png[kKindOfColour], 3);
  const double off = cv::norm(read_back(png), image, cv::NORM_INF);
  EXPECT_GT(off, 0);
  EXPECT_LE(off, 6);
  EXPECT_EQ(to_png(image), png);
}

TEST(PngBytes, ManyColoursStayAsTheyAre) {
  cv::Mat image(64, 64, CV_8UC3);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  const std::vector<unsigned char> png = to_png(image);
  EXPECT_EQ(png[kKindOfColour], 2);
  EXPECT_EQ(cv::norm(read_back(png), image, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace foucault::plot
