#include "foucault/plot/renderer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "drawn.h"
#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Renderer, DrawsEightPixelsAMillimetre) {
  const cv::Mat image = draw(curve({0, 1}, {0, 1}));
  EXPECT_EQ(image.cols, 960);
  EXPECT_EQ(image.rows, 640);
}

TEST(Renderer, PutsInkIntoThePlot) {
  EXPECT_GT(ink_in(draw(curve({0, 1, 2}, {0, 1, 0})), Ink::blue, kInside), 800);
}

TEST(Renderer, DoesNotJoinWhatAGapParts) {
  const cv::Rect2d middle(0.45, 0.1, 0.2, 0.75);
  EXPECT_GT(ink_in(draw(curve({0, 1, 9, 10}, {0, 1, 1, 0})), Ink::blue, middle), 300);
  EXPECT_EQ(ink_in(draw(curve({0, 1, 5, 9, 10}, {0, 1, kNaN, 1, 0})), Ink::blue, middle), 0);
}

TEST(Renderer, SurvivesEmptyAndUglyData) {
  const std::vector<Figure> ugly{curve({}, {}),
                                 curve({1}, {1}),
                                 curve({0, 1, 2}, {kNaN, kInfinity, -kInfinity}),
                                 curve({kNaN, kInfinity}, {0, 1}),
                                 curve({0, 1}, {1e300, -1e300}),
                                 curve({0, 0}, {1e-300, 0})};
  for (Figure figure : ugly) {
    for (const AxisKind kind : {AxisKind::linear, AxisKind::log, AxisKind::duration}) {
      figure.panels[0].x.kind = kind;
      figure.panels[0].y.kind = kind;
      EXPECT_EQ(draw(figure).cols, 960);
    }
  }
  EXPECT_EQ(draw(Figure{}).cols, 2000) << "no panels at all";
}

/// As wide as a column of a journal, letters in points of print.
TEST(Renderer, VectorsFitAColumnOfAPaper) {
  Figure figure = curve({0, 1, 2}, {0, 1, 0});
  Renderer renderer;
  const std::string column = renderer.svg(figure);
  EXPECT_NE(column.find("width=\"85.0mm\""), std::string::npos) << column.substr(0, 200);
  EXPECT_EQ(column.find(figure.title), std::string::npos) << "titles are a caption's";
  // 7 pt on paper: pixels of the drawing, of which 874 are 85 mm.
  const double em = 7 * 25.4 / 72 / 85 * 874;
  EXPECT_NE(column.find(fmt::format("font-size=\"{:.1f}\"", em)), std::string::npos) << em;
  figure.columns = 2;
  figure.panels.push_back(figure.panels[0]);
  EXPECT_NE(renderer.svg(figure).find("width=\"178.0mm\""), std::string::npos);
}

TEST(Renderer, ABandIsOneShapeBetweenGaps) {
  Figure figure = curve({0, 1, 2, 3, 4, 5}, {});
  Series& band = figure.panels[0].series[0];
  band.mark = Mark::band;
  band.lower = {0, 0, 0, kNaN, 0, 0};
  band.upper = {1, 2, 1, 1, 2, 1};
  const std::string svg = Renderer().svg(figure);
  EXPECT_EQ(std::count(svg.begin(), svg.end(), 'Z'), 2);
  // No seam between its parts: all of what is within it has its colour.
  const cv::Mat image = draw(figure);
  EXPECT_GT(ink_in(image, Ink::blue, {0.2, 0.6, 0.15, 0.1}), 0.99 * 0.15 * 0.1 * image.total());
}

TEST(Renderer, GivesTheSameBytesAgain) {
  const Figure figure = curve({0, 1, 2, 3}, {0, 3, 1, 2});
  Renderer renderer;
  EXPECT_EQ(renderer.png(figure), renderer.png(figure));
  EXPECT_EQ(renderer.png(figure), Renderer().png(figure));
}

TEST(Renderer, DrawsEveryMark) {
  for (const Mark mark : {Mark::line, Mark::steps, Mark::points, Mark::bars, Mark::band}) {
    Figure figure = curve({0, 1, 2, 3}, {2, 3, 1, 2});
    Series& series = figure.panels[0].series[0];
    series.mark = mark;
    series.size = 6;
    if (mark == Mark::band) {
      series.lower = {1, 2, 0, 1};
      series.upper = {2, 3, 1, 2};
      series.y.clear();
    }
    EXPECT_GT(ink_in(draw(figure), Ink::blue, kInside), 100) << static_cast<int>(mark);
  }
}

TEST(Renderer, DrawsEveryShape) {
  for (int shape = 0; shape <= static_cast<int>(Shape::frame); ++shape) {
    Figure figure = curve({0, 1, 2, 3}, {2, 2.5, 1.5, 2});
    Series& series = figure.panels[0].series[0];
    series.mark = Mark::points;
    series.shape = static_cast<Shape>(shape);
    series.size = 9;
    EXPECT_GT(ink_in(draw(figure), Ink::blue, kInside), 40) << shape;
  }
}

TEST(Renderer, ColoursPointsByCategory) {
  Figure figure = curve({0, 1, 2, 3}, {1, 1, 1, 1});
  Series& series = figure.panels[0].series[0];
  series.mark = Mark::points;
  series.size = 9;
  series.categories = {{"fixed", Ink::green}, {"float", Ink::orange}};
  series.category = {0, 0, 1, 0};
  const cv::Mat image = draw(figure);
  EXPECT_GT(ink_in(image, Ink::green, kInside), 100);
  EXPECT_GT(ink_in(image, Ink::orange, kInside), 50);
  EXPECT_EQ(ink_in(image, Ink::blue, kInside), 0);
}

TEST(Renderer, MarksPointsOutsideOfTheRangeAtTheBorder) {
  Figure figure = curve({0, 1, 2, 3}, {0, 0, 500, 0});
  figure.panels[0].series[0].mark = Mark::points;
  figure.panels[0].y.min = -1;
  figure.panels[0].y.max = 1;
  const cv::Rect2d upper_edge(0.15, 0.05, 0.8, 0.2);
  EXPECT_GT(ink_in(draw(figure), Ink::blue, upper_edge), 20);
}

TEST(Renderer, EqualAspectMakesACircleRound) {
  std::vector<double> x, y;
  for (int i = 0; i <= 100; ++i) {
    x.push_back(std::cos(i * 2 * M_PI / 100));
    y.push_back(std::sin(i * 2 * M_PI / 100));
  }
  Figure figure = curve(x, y);
  figure.panels[0].equal_aspect = true;
  const cv::Mat image = draw(figure);
  int left = image.cols, right = 0, top = image.rows, bottom = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      if (!is_near(image.at<cv::Vec3b>(row, column), Ink::blue)) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  }
  EXPECT_NEAR(right - left, bottom - top, 2);
  EXPECT_GT(right - left, 300);
}

TEST(Renderer, DrawsAHeatMapWithAllItsColours) {
  Figure figure;
  figure.width_mm = 120;
  figure.height_mm = 80;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.x.kind = panel.y.kind = AxisKind::category;
  panel.x.categories = {"1", "2", "5"};
  panel.y.categories = {"10", "20"};
  panel.heat_map = HeatMap{3, 2, {1, 2, 3, 4, kNaN, 6}};
  EXPECT_EQ(draw(figure).cols, 960);
  panel.heat_map->values.pop_back();
  EXPECT_THROW(draw(figure), DataError);
}

TEST(Renderer, RefusesColumnsOfDifferentLength) {
  Figure figure = curve({0, 1, 2}, {0, 1, 0});
  figure.panels[0].series[0].y.pop_back();
  try {
    draw(figure);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("curve"), std::string::npos) << error.what();
  }
  figure = curve({0, 1}, {0, 1});
  figure.panels[0].series[0].categories = {{"one", Ink::blue}};
  figure.panels[0].series[0].category = {0, 1};
  EXPECT_THROW(draw(figure), DataError) << "a category that is not there";
}

class FontEnvironment : public ::testing::Test {
 protected:
  void TearDown() override { unsetenv("FOUCAULT_FONT"); }
};

TEST_F(FontEnvironment, MissingFontNamesThePackage) {
  setenv("FOUCAULT_FONT", "/nowhere/at/all.ttf", 1);
  try {
    find_fonts();
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("fonts-dejavu-core"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.ttf"), std::string::npos);
  }
}

TEST_F(FontEnvironment, TakesAFileOrAFolder) {
  const Fonts usual = find_fonts();
  setenv("FOUCAULT_FONT", usual.regular.c_str(), 1);
  EXPECT_EQ(find_fonts().bold, usual.bold);
  setenv("FOUCAULT_FONT", std::filesystem::path(usual.regular).parent_path().c_str(), 1);
  EXPECT_EQ(find_fonts().regular, usual.regular);
}

TEST_F(FontEnvironment, FileThatIsNoFontIsAnError) {
  EXPECT_THROW(Renderer({"/proc/self/exe", "/proc/self/exe"}), DataError);
}

}  // namespace
}  // namespace foucault::plot
