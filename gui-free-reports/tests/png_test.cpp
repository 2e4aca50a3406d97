#include "png.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace foucault::reports {
namespace {

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(Png, OpenCvReadsWhatWasWritten) {
  cv::Mat image(70, 113, CV_8UC3, cv::Scalar(10, 120, 250));
  image(cv::Rect(3, 5, 60, 40)).setTo(cv::Scalar(255, 0, 7));
  EXPECT_TRUE(same(cv::imdecode(to_png(image), cv::IMREAD_UNCHANGED), image));
}

TEST(Png, GrowsForWhatDoesNotCompress) {
  cv::Mat noise(600, 800, CV_8UC3);  // 1.4 MB, several times what is expected
  cv::RNG random(42);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  EXPECT_TRUE(same(cv::imdecode(to_png(noise), cv::IMREAD_UNCHANGED), noise));
}

TEST(Png, PartsOfAnImageHaveTheirOwnRows) {
  cv::Mat noise(60, 80, CV_8UC3);
  cv::RNG random(42);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  const cv::Mat part = noise(cv::Rect(10, 20, 33, 17));
  EXPECT_TRUE(same(cv::imdecode(to_png(part), cv::IMREAD_UNCHANGED), part.clone()));
}

}  // namespace
}  // namespace foucault::reports
