#include "foucault/plot/ticks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace foucault::plot {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> labels(const Ticks& ticks) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks.ticks) {
    if (!tick.label.empty()) result.push_back(tick.label);
  }
  return result;
}

TEST(LinearTicks, AreRoundWithMinimalDecimals) {
  EXPECT_THAT(labels(linear_ticks(0, 10, 5)), ElementsAre("0", "2", "4", "6", "8", "10"));
  EXPECT_THAT(labels(linear_ticks(-0.3, 0.3, 3)), ElementsAre("−0.2", "0.0", "0.2"));
  EXPECT_THAT(labels(linear_ticks(-0.04, 1.1, 3)), ElementsAre("0.0", "0.5", "1.0"));
}

TEST(LinearTicks, StepsAreOneTwoOrFive) {
  for (double span = 1e-4; span < 1e5; span *= 1.37) {
    const Ticks ticks = linear_ticks(0, span, 6);
    ASSERT_GE(ticks.ticks.size(), 3U) << span;
    EXPECT_LE(ticks.ticks.size(), 8U) << span;
    const double step = ticks.ticks[1].at - ticks.ticks[0].at;
    const double mantissa = step / std::pow(10, std::floor(std::log10(step) + 1e-9));
    const double nearest = mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : 5;
    EXPECT_NEAR(mantissa, nearest, 1e-6) << span;
  }
}

TEST(LinearTicks, TakeOutAPowerOfTenOfTinyAndHugeNumbers) {
  const Ticks tiny = linear_ticks(0, 4e-5, 4);
  EXPECT_EQ(tiny.exponent, "×10⁻⁶");
  EXPECT_THAT(labels(tiny), ElementsAre("0", "10", "20", "30", "40"));
  EXPECT_DOUBLE_EQ(tiny.ticks[2].at, 2e-5);
  EXPECT_EQ(linear_ticks(0, 3e7, 3).exponent, "×10⁶");
}

TEST(LinearTicks, ShowAnotherUnit) {
  const Ticks ticks = linear_ticks(0, 0.1, 2, 100, "cm");
  EXPECT_THAT(labels(ticks), ElementsAre("0", "5", "10"));
  EXPECT_EQ(ticks.unit, "cm");
  EXPECT_DOUBLE_EQ(ticks.ticks[1].at, 0.05);
}

TEST(LogTicks, LabelDecadesWithMinorTicksBetween) {
  const Ticks ticks = log_ticks(1e-3, 1e3, 8);
  EXPECT_THAT(labels(ticks), ElementsAre("0.001", "0.01", "0.1", "1", "10", "100", "1000"));
  EXPECT_EQ(ticks.ticks.size(), 6U * 9 + 1);
  EXPECT_THAT(labels(log_ticks(1e-9, 1, 4)), ElementsAre("10⁻⁹", "10⁻⁶", "0.001", "1"));
}

TEST(LogTicks, LabelSubdivisionsOfFewDecades) {
  EXPECT_THAT(labels(log_ticks(0.8, 22, 5)), ElementsAre("1", "2", "5", "10", "20"));
  EXPECT_THAT(labels(log_ticks(0.009, 0.06, 5)), ElementsAre("0.01", "0.02", "0.03", "0.05"));
}

TEST(BearingTicks, DivideACircle) {
  std::vector<double> places;
  for (const Tick& tick : bearing_ticks(0, 360, 5).ticks) places.push_back(tick.at);
  EXPECT_EQ(places, (std::vector<double>{0, 90, 180, 270, 360}));
  EXPECT_EQ(bearing_ticks(80, 100, 4).ticks.size(), 5U) << "by five";
}

TEST(DurationTicks, ChooseAUnitThatSuitsAClock) {
  EXPECT_EQ(duration_ticks(0, 120, 6).unit, "s");
  const Ticks minutes = duration_ticks(0, 1800, 6);
  EXPECT_EQ(minutes.unit, "min");
  EXPECT_THAT(labels(minutes), ElementsAre("0", "5", "10", "15", "20", "25", "30"));
  EXPECT_DOUBLE_EQ(minutes.ticks[1].at, 300);
  const Ticks day = duration_ticks(0, 86400, 8);
  EXPECT_EQ(day.unit, "h");
  EXPECT_THAT(labels(day), ElementsAre("0", "3", "6", "9", "12", "15", "18", "21", "24"));
}

}  // namespace
}  // namespace foucault::plot
