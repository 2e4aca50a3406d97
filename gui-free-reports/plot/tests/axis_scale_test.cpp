#include "foucault/plot/axis_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace foucault::plot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Panel with_y(const std::vector<double>& y) {
  Panel panel;
  Series series;
  series.y = y;
  for (size_t i = 0; i < y.size(); ++i) series.x.push_back(static_cast<double>(i));
  panel.series.push_back(series);
  return panel;
}

TEST(YSpan, HoldsTheDataWithLittleRoom) {
  const Span span = y_span(with_y({-1, 3, 2}));
  EXPECT_LT(span.min, -1);
  EXPECT_GT(span.max, 3);
  EXPECT_LT(span.width(), 1.2 * 4);
}

TEST(YSpan, IgnoresWhatIsNotFinite) {
  const Span span = y_span(with_y({kNaN, 1, kInfinity, 2, -kInfinity}));
  EXPECT_GT(span.min, 0.8);
  EXPECT_LT(span.max, 2.2);
}

TEST(YSpan, IsNeverEmpty) {
  for (const Panel& panel : {with_y({}), with_y({5, 5, 5}), with_y({kNaN}), with_y({0})}) {
    const Span span = y_span(panel);
    EXPECT_TRUE(std::isfinite(span.min) && std::isfinite(span.max));
    EXPECT_GT(span.width(), 0);
  }
}

TEST(YSpan, IsSymmetricAboutZeroOnRequest) {
  Panel panel = with_y({-1, 3});
  panel.y.zero_centred = true;
  const Span span = y_span(panel);
  EXPECT_DOUBLE_EQ(span.min, -span.max);
  EXPECT_GT(span.max, 3);
}

TEST(YSpan, LeavesOutRejectedAndUntypicalNumbers) {
  Panel panel = with_y(std::vector<double>(100, 1));
  panel.series.front().y.front() = 1e6;
  panel.series.front().range_role = RangeRole::typical;
  EXPECT_LT(y_span(panel).max, 2);
  panel.series.front().range_role = RangeRole::full;
  EXPECT_GT(y_span(panel).max, 1e6);
  panel.series.front().range_role = RangeRole::none;
  EXPECT_LE(y_span(panel).max, 2);
}

TEST(YSpan, LeavesOutFarOutliersOnly) {
  std::vector<double> y;
  for (int i = 0; i <= 1000; ++i) y.push_back(std::sin(i));
  y[100] = 1.3;
  y[500] = 40;
  Panel panel = with_y(y);
  panel.series.front().range_role = RangeRole::most;
  EXPECT_GT(y_span(panel).max, 1.3);
  EXPECT_LT(y_span(panel).max, 2);
}

TEST(YSpan, LogAxisTakesPositiveNumbersOnly) {
  Panel panel = with_y({-5, 0, 0.01, 100});
  panel.y.kind = AxisKind::log;
  const Span span = y_span(panel);
  EXPECT_GT(span.min, 0.001);
  EXPECT_LE(span.min, 0.01);
  EXPECT_GE(span.max, 100);
}

TEST(YSpan, FixedEndsWin) {
  Panel panel = with_y({-5, 5});
  panel.y.min = 0;
  panel.y.max = 2;
  EXPECT_EQ(y_span(panel).min, 0);
  EXPECT_EQ(y_span(panel).max, 2);
}

TEST(AxisScale, MapsEndsAndMiddle) {
  Axis axis;
  const AxisScale linear(axis, {0, 10}, 100, 0);
  EXPECT_DOUBLE_EQ(linear.pixel(0), 100);
  EXPECT_DOUBLE_EQ(linear.pixel(2.5), 75);
  axis.kind = AxisKind::log;
  const AxisScale log(axis, {0.01, 100}, 0, 200);
  EXPECT_NEAR(log.pixel(1), 100, 1e-9);
  EXPECT_FALSE(std::isfinite(log.pixel(0)));
}

TEST(AxisTitle, NamesTheUnitThatTheTicksShow) {
  Axis axis;
  axis.label = "Time";
  axis.unit = "s";
  axis.kind = AxisKind::duration;
  EXPECT_EQ(axis_title(axis, AxisScale(axis, {0, 1200}, 0, 1000).ticks(6)), "Time (min)");
  Axis error;
  error.label = "North";
  error.unit = "m";
  error.shown_unit = "cm";
  error.shown_factor = 100;
  const Ticks ticks = AxisScale(error, {-0.02, 0.02}, 0, 1000).ticks(4);
  EXPECT_EQ(axis_title(error, ticks), "North (cm)");
  EXPECT_EQ(ticks.ticks.front().label, "−2");
  EXPECT_DOUBLE_EQ(ticks.ticks.front().at, -0.02);
}

}  // namespace
}  // namespace foucault::plot
