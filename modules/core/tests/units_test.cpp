#include "foucault/core/units.h"

#include <gtest/gtest.h>

namespace foucault::units {
namespace {

TEST(Units, StampsAreExact) {
  EXPECT_EQ(format_stamp(1'700'000'000'000'000'001), "1700000000.000000001");
  EXPECT_EQ(format_stamp(-500'000'000), "-0.500000000");
}

TEST(Units, UtcCutsTheFractionOff) {
  EXPECT_EQ(format_utc(1'751'999'999'999'999'999), "2025-07-08T18:39:59Z");
  EXPECT_EQ(format_utc(-1), "1969-12-31T23:59:59Z");
}

}  // namespace
}  // namespace foucault::units
