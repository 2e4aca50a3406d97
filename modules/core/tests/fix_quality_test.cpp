#include "foucault/core/fix_quality.h"

#include <gtest/gtest.h>

namespace foucault {
namespace {

TEST(FixQuality, NamesLeadBackAndAreUnique) {
  for (int q = 0; q <= static_cast<int>(FixQuality::fixed_rtk); ++q) {
    const auto quality = static_cast<FixQuality>(q);
    EXPECT_EQ(fix_quality(name_of(quality)), quality) << name_of(quality);
  }
  EXPECT_EQ(name_of(FixQuality::float_rtk), "float_rtk");
  EXPECT_EQ(words_of(FixQuality::float_rtk), "RTK float");
}

TEST(FixQuality, OtherNamesAreNone) {
  for (const char* name : {"", "none", "any", "RTK fixed", "Single"}) {
    EXPECT_FALSE(fix_quality(name)) << name;
  }
}

}  // namespace
}  // namespace foucault
