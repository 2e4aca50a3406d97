#include "foucault/core/units.h"

#include <gtest/gtest.h>

namespace foucault::units {
namespace {

TEST(Units, StampsAreExact) {
  EXPECT_EQ(format_stamp(1'700'000'000'000'000'001), "1700000000.000000001");
  EXPECT_EQ(format_stamp(-500'000'000), "-0.500000000");
}

}  // namespace
}  // namespace foucault::units
