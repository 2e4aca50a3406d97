#include "foucault/plot/palette.h"

#include <gtest/gtest.h>

#include <set>

#include "foucault/core/error.h"

namespace foucault::plot {
namespace {

bool operator==(Rgb a, Rgb b) { return a.red == b.red && a.green == b.green && a.blue == b.blue; }

TEST(Palette, EveryInkHasANameThatLeadsBackToIt) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(Ink::yellow); ++i) {
    const Ink ink = static_cast<Ink>(i);
    EXPECT_EQ(ink_from_name(ink_name(ink)), ink);
    names.insert(ink_name(ink));
  }
  EXPECT_EQ(names.size(), 10U);
  EXPECT_THROW(ink_from_name("mauve"), DataError);
}

TEST(Palette, ColoursAreThoseOfOkabeAndIto) {
  EXPECT_TRUE(rgb(Ink::blue) == (Rgb{0, 114, 178}));
  EXPECT_TRUE(rgb(Ink::vermillion) == (Rgb{213, 94, 0}));
}

TEST(Palette, EqualCurvesBeginAnewAfterSeven) {
  std::set<Ink> inks;
  for (size_t i = 0; i < 7; ++i) inks.insert(ink_of(i));
  EXPECT_EQ(inks.size(), 7U);
  EXPECT_EQ(ink_of(7), ink_of(0));
}

TEST(Colormap, GoesFromVioletToYellowAndClamps) {
  EXPECT_TRUE(colormap(0) == (Rgb{68, 1, 84}));
  EXPECT_TRUE(colormap(1) == (Rgb{253, 231, 37}));
  EXPECT_TRUE(colormap(-3) == colormap(0));
  EXPECT_TRUE(colormap(7) == colormap(1));
  EXPECT_TRUE(colormap(0.5) == (Rgb{33, 144, 141})) << "an anchor";
  EXPECT_EQ(colormap(1.0 / 16).green, 23) << "half way from 1 to 44, rounded";
}

}  // namespace
}  // namespace foucault::plot
