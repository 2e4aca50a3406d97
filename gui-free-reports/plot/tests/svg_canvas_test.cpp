#include "svg_canvas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "foucault/plot/figure.h"

namespace foucault::plot {
namespace {

using ::testing::HasSubstr;

class AsVectors : public ::testing::Test {
 protected:
  Typesetter typesetter_{find_fonts()};
  SvgCanvas canvas_{{800, 400}, typesetter_};
};

TEST_F(AsVectors, TheFileIsAsLargeAsTheFigureOnPaper) {
  EXPECT_THAT(canvas_.svg(),
              HasSubstr("width=\"100.0mm\" height=\"50.0mm\" viewBox=\"0 0 800 400\""));
}

TEST_F(AsVectors, LinesAreBrokenAsInImages) {
  canvas_.polylines({{{0, 0}, {100, 50}}}, {rgb(Ink::blue), 2, 1, Dash::dashes}, {0, 0, 800, 400});
  EXPECT_THAT(canvas_.svg(), HasSubstr("<path d=\"M0.0 0.0L100.0 50.0\" fill=\"none\" "
                                       "stroke=\"#0072b2\" stroke-width=\"2.0\""));
  EXPECT_THAT(canvas_.svg(), HasSubstr("stroke-dasharray=\"9.0 6.0\""));
}

TEST_F(AsVectors, ClipsAreDefinedOnce) {
  const cv::Rect clip(10, 20, 30, 40);
  for (int i = 0; i < 2; ++i) canvas_.markers({{15, 25}}, Shape::dot, 4, rgb(Ink::blue), 1, clip);
  const std::string svg = canvas_.svg();
  EXPECT_THAT(
      svg, HasSubstr("<clipPath id=\"c0\"><rect x=\"10\" y=\"20\" width=\"30\" height=\"40\"/>"));
  EXPECT_EQ(svg.find("c1"), std::string::npos);
}

TEST_F(AsVectors, PointsThatLieOnEachOtherAreLeftOut) {
  Polyline line;
  for (int i = 0; i <= 1000; ++i) line.emplace_back(0.1 * i, 7);
  canvas_.polylines({line}, {rgb(Ink::blue), 1}, {0, 0, 800, 400});
  const std::string svg = canvas_.svg();
  EXPECT_LT(std::count(svg.begin(), svg.end(), 'L'), 210);
  EXPECT_THAT(svg, HasSubstr("L100.0 7.0")) << "the end stays";
}

TEST_F(AsVectors, TextIsTextAndEscaped) {
  TextStyle style;
  style.upwards = true;
  canvas_.text("a < b & c", {5, 6}, style);
  EXPECT_THAT(canvas_.svg(), HasSubstr("rotate(-90)"));
  EXPECT_THAT(canvas_.svg(), HasSubstr(">a &lt; b &amp; c</text>"));
}

}  // namespace
}  // namespace foucault::plot
