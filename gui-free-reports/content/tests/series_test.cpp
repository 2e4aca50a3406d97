#include "series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "map_unit.h"

namespace foucault::content {
namespace {

using namespace plot;

TEST(Series, PointsAndLinesCarryTheirLook) {
  const Series series = points("fix", Ink::green, 4, {1, 2}, {3, 4});
  EXPECT_EQ(series.mark, Mark::points);
  EXPECT_EQ(series.ink, Ink::green);
  EXPECT_EQ(series.size, 4);
  EXPECT_EQ(series.y, (std::vector<double>{3, 4}));
  EXPECT_EQ(line("a", Ink::blue, {}, {}).mark, Mark::line);
  EXPECT_EQ(time_axis().kind, AxisKind::duration);
}

TEST(Series, LevelsOfABandArePartedByGaps) {
  Series band = pale_band("95 %", "band");
  EXPECT_EQ(band.column, "band");
  add_level(0, 2, -1, 1, band);
  add_level(5, 6, -2, 2, band);
  EXPECT_EQ(band.x, (std::vector<double>{0, 2, 2, 5, 6, 6}));
  EXPECT_EQ(band.upper[1], 1);
  EXPECT_TRUE(std::isnan(band.lower[2]));
  EXPECT_TRUE(std::isnan(band.upper[5]));
}

TEST(PositiveRange, EndsAtPowersOfTenAroundWhatIsPositiveAndFinite) {
  PositiveRange range;
  Axis axis;
  range.fit(axis);
  EXPECT_FALSE(axis.min || axis.max) << "nothing to show";
  range.take({0, -3, std::nan(""), std::numeric_limits<double>::infinity()});
  EXPECT_TRUE(range.empty());
  range.take({0.02, 7});
  range.fit(axis);
  EXPECT_DOUBLE_EQ(*axis.min, 0.01);
  EXPECT_DOUBLE_EQ(*axis.max, 10);
  range.fit(axis, 3, 30);
  EXPECT_DOUBLE_EQ(*axis.min, 0.001);
  EXPECT_DOUBLE_EQ(*axis.max, 1000);
}

TEST(MapUnit, IsKilometresBeyondTwenty) {
  Panel panel;
  panel.series = {line("track", Ink::blue, {0, 19e3}, {0, kNoValue})};
  choose_map_unit(panel);
  EXPECT_EQ(panel.x.shown_unit, "");
  panel.series[0].y[0] = -21e3;
  choose_map_unit(panel);
  EXPECT_EQ(panel.x.shown_unit, "km");
  EXPECT_EQ(panel.y.shown_factor, 1e-3);
}

}  // namespace
}  // namespace foucault::content
