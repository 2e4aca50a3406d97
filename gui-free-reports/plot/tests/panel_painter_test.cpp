#include <gtest/gtest.h>

#include "drawn.h"

namespace foucault::plot {
namespace {

const cv::Rect2d kAll(0, 0, 1, 1);
// The middle of the axes lies right of that of the page.
const cv::Rect2d kLeft(0, 0, 0.543, 1);
const cv::Rect2d kRight(0.543, 0, 0.457, 1);

Figure hidden_curve() {
  Figure figure = curve({0, 10}, {0, 10});
  figure.panels[0].series[0].ink = Ink::light_gray;
  return figure;
}

int drawn(const Figure& figure, Ink ink, const cv::Rect2d& where = kAll) {
  return ink_in(draw(figure), ink, where);
}

TEST(PanelPainter, ReferenceLinesAreDrawnAndNamedWithinTheAxes) {
  Figure figure = hidden_curve();
  const auto ink_of_line = [&](const ReferenceLine& line) {
    figure.panels[0].lines = {line};
    return drawn(figure, Ink::purple);
  };
  for (const Direction direction : {Direction::horizontal, Direction::vertical}) {
    const int whole = ink_of_line({direction, 5, "", Ink::purple, false});
    EXPECT_GT(whole, 600);
    EXPECT_LT(ink_of_line({direction, 5, "", Ink::purple, true}), whole);
    EXPECT_GT(ink_of_line({direction, 5, "name", Ink::purple, false}), whole + 100);
    EXPECT_EQ(ink_of_line({direction, 50, "name", Ink::purple, false}), 0) << "outside";
  }
}

TEST(PanelPainter, NamesOfLevelLinesStandWhereThereAreFewerData) {
  Figure figure = curve({9.0, 9.2, 9.4, 9.6, 9.8, 10, 0}, {5, 5.1, 5, 5.1, 5, 5.1, 5});
  figure.panels[0].series[0].mark = Mark::points;
  figure.panels[0].lines = {{Direction::horizontal, 5, "MMMMMM", Ink::purple, true}};
  EXPECT_GT(drawn(figure, Ink::purple, kLeft), drawn(figure, Ink::purple, kRight) + 200);
}

TEST(PanelPainter, AnnotationsStandOnTheirSideOrTheOtherAtTheBorder) {
  Figure figure = hidden_curve();
  const auto ink_beside = [&](double x, Side side, const cv::Rect2d& where) {
    figure.panels[0].annotations = {{x, 5, "MMM", side, Ink::purple}};
    return drawn(figure, Ink::purple, where);
  };
  EXPECT_GT(ink_beside(5, Side::right, kRight), 5 * ink_beside(5, Side::right, kLeft));
  EXPECT_GT(ink_beside(5, Side::left, kLeft), 5 * ink_beside(5, Side::left, kRight));
  for (const Side side : {Side::above, Side::below, Side::centre}) {
    EXPECT_GT(ink_beside(5, side, kAll), 200);
  }
  EXPECT_GT(ink_beside(10, Side::right, kAll), 200) << "no room at the right";
  EXPECT_GT(ink_beside(0, Side::left, kAll), 200) << "no room at the left";
  EXPECT_EQ(ink_beside(50, Side::left, kAll), 0) << "outside of the axes";
}

TEST(PanelPainter, LinesThatLeaveTheAxisAreMarkedThere) {
  Figure figure = curve({0, 4, 5, 6, 10}, {1, 1, 1, 1, 1});
  figure.panels[0].y.min = 0;
  figure.panels[0].y.max = 2;
  figure.panels[0].series[0].ink = Ink::purple;
  // Over the middle, where the line itself is beyond the axis.
  const cv::Rect2d above(0.505, 0, 0.036, 0.4);
  EXPECT_EQ(drawn(figure, Ink::purple, above), 0);
  figure.panels[0].series[0].y[2] = -9;
  EXPECT_EQ(drawn(figure, Ink::purple, above), 0);
  figure.panels[0].series[0].y[2] = 9;
  EXPECT_GT(drawn(figure, Ink::purple, above), 30);
}

TEST(PanelPainter, ShadesReachAsFarAsTheAxes) {
  Figure figure = hidden_curve();
  const auto pale = [&](double begin, double end) {
    figure.panels[0].shades = {{begin, end, "", Ink::blue}};
    const cv::Mat image = draw(figure);
    int count = 0;
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3b& p = image.at<cv::Vec3b>(image.rows / 3, x);
      count += p[0] > p[2] + 25 ? 1 : 0;
    }
    return count;
  };
  EXPECT_NEAR(pale(-100, 100), 2 * pale(-100, 5), 15) << "the middle of the axis";
  EXPECT_GT(pale(5, 5.0001), 0) << "never too narrow to be seen";
  EXPECT_EQ(pale(7, 6), 0);
  EXPECT_EQ(pale(50, 60), 0);
}

TEST(PanelPainter, ValuesColourLinesAndPoints) {
  for (const Mark mark : {Mark::line, Mark::points}) {
    Figure figure = curve({0, 1, 2, 3, 4}, {1, 1, 1, 1, 1});
    Series& series = figure.panels[0].series[0];
    series.mark = mark;
    series.size = 8;
    series.value = {0, 0, 0, 10, std::nan("")};
    figure.panels[0].colour = {"Speed", "m/s"};
    EXPECT_EQ(drawn(figure, Ink::blue, kInside), 0);
    const cv::Mat image = draw(figure);
    int violet = 0;
    for (int y = 0; y < image.rows; ++y) {
      for (int x = image.cols / 5; x < image.cols / 2; ++x) {
        const cv::Vec3b& p = image.at<cv::Vec3b>(y, x);
        violet += p[2] > 60 && p[2] < 85 && p[1] < 30 && p[0] > 80 ? 1 : 0;
      }
    }
    EXPECT_GT(violet, 100) << "the low end of the colours";
  }
}

TEST(PanelPainter, BarsStandOnZeroSideBySideWithTheirIntervalsAndNumbers) {
  Figure figure = curve({0, 1}, {2, -2});
  Panel& panel = figure.panels[0];
  panel.x.kind = AxisKind::category;
  panel.x.categories = {"a", "b"};
  panel.series[0].mark = Mark::bars;
  const int alone = drawn(figure, Ink::blue);
  EXPECT_NEAR(drawn(figure, Ink::blue, kLeft), alone / 2, alone / 5);
  const int text = drawn(figure, Ink::black);
  panel.series[0].lower = {1.5, -2.5};
  panel.series[0].upper = {2.5, std::nan("")};
  panel.series[0].value_labels = true;
  EXPECT_GT(drawn(figure, Ink::black), text + 20) << "an interval";
  panel.series.push_back(panel.series[0]);
  panel.series[1].ink = Ink::orange;
  EXPECT_LT(drawn(figure, Ink::blue), 0.6 * alone);
  EXPECT_GT(drawn(figure, Ink::orange), 0.3 * alone);
  panel.y.kind = AxisKind::log;
  EXPECT_GT(drawn(figure, Ink::blue, kLeft), 100) << "from the lower border";
  EXPECT_EQ(drawn(figure, Ink::blue, {0.6, 0, 0.4, 1}), 0) << "no bar below zero";
}

TEST(PanelPainter, PointsHaveIntervalsAndArrowheadsBeyondBothBorders) {
  Figure figure = curve({0, 1, 2}, {0, 5, -5});
  Series& series = figure.panels[0].series[0];
  series.mark = Mark::points;
  figure.panels[0].y.min = -1;
  figure.panels[0].y.max = 1;
  const int bare = drawn(figure, Ink::blue);
  EXPECT_GT(drawn(figure, Ink::blue, {0, 0, 1, 0.3}), 20);
  EXPECT_GT(drawn(figure, Ink::blue, {0, 0.6, 1, 0.4}), 20);
  series.lower = {-0.5, 4, -6};
  series.upper = {0.5, 6, -4};
  EXPECT_GT(drawn(figure, Ink::blue), bare + 100);
}

TEST(PanelPainter, ABandEndsAtAGap) {
  Figure figure = curve({0, 1, 2, 3}, {});
  Series& band = figure.panels[0].series[0];
  band.mark = Mark::band;
  band.lower = {0, 0, 0, 0};
  band.upper = {1, 1, 1, 1};
  const int whole = drawn(figure, Ink::blue);
  band.upper[3] = kNoValue;
  EXPECT_NEAR(drawn(figure, Ink::blue), whole * 2 / 3, whole / 20);
}

TEST(PanelPainter, AScaleBarHasARoundLengthInWords) {
  Figure figure = hidden_curve();
  Panel& panel = figure.panels[0];
  panel.equal_aspect = true;
  panel.x.unit = "m";
  const int without = drawn(figure, Ink::black);
  panel.scale_bar = true;
  EXPECT_GT(drawn(figure, Ink::black), without + 200);
  for (double& x : panel.series[0].x) x *= 4000;
  EXPECT_GT(drawn(figure, Ink::black), 200) << "in kilometres";
}

TEST(PanelPainter, CellsOfAHeatMapHaveColoursNumbersAndFrames) {
  Figure figure;
  figure.width_mm = 120;
  figure.height_mm = 80;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.x.kind = panel.y.kind = AxisKind::category;
  panel.x.categories = {"1", "2"};
  panel.y.categories = {"10", "20"};
  panel.heat_map = HeatMap{2, 2, {1, 2, 3, kNoValue}};
  EXPECT_EQ(drawn(figure, Ink::vermillion), 0);
  panel.series = {{"chosen", {}, Mark::points, Ink::vermillion, Shape::frame}};
  panel.series[0].in_legend = false;
  panel.series[0].x = {1, kNoValue};
  panel.series[0].y = {0, 0};
  EXPECT_GT(drawn(figure, Ink::vermillion, kRight), 500);
  EXPECT_LT(drawn(figure, Ink::vermillion, {0, 0, 0.35, 1}), 1);
}

}  // namespace
}  // namespace foucault::plot
