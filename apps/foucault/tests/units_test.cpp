#include "units.h"

#include <gtest/gtest.h>

#include "arguments.h"
#include "foucault/core/error.h"

namespace foucault::app {
namespace {

TEST(Units, StampsAreExact) {
  EXPECT_EQ(format_stamp(1'700'000'000'000'000'001), "1700000000.000000001");
  EXPECT_EQ(format_stamp(-500'000'000), "-0.500000000");
}

TEST(Units, UtcCutsTheFractionOff) {
  EXPECT_EQ(format_utc(1'751'999'999'999'999'999), "2025-07-08T18:39:59Z");
  EXPECT_EQ(format_utc(-1), "1969-12-31T23:59:59Z");
}

TEST(Arguments, VectorsOfThree) {
  EXPECT_EQ(parse_vector3("--lever-arm", "0.1,-0.3,-0.8"), Eigen::Vector3d(0.1, -0.3, -0.8));
  for (const char* wrong : {"", "1,2", "1,2,3,4", "1 2 3", "1,2,x", "1,2,nan"}) {
    EXPECT_THROW(parse_vector3("--lever-arm", wrong), UsageError) << wrong;
  }
}

}  // namespace
}  // namespace foucault::app
