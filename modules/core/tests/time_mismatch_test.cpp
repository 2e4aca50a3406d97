#include "foucault/core/time_mismatch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foucault/core/constants.h"

namespace foucault {
namespace {

using ::testing::HasSubstr;

TEST(TimeMismatch, NamesTheConfusionOfClocks) {
  EXPECT_THAT(describe_mismatch(3.2), HasSubstr("3.20 s after the IMU; check the time systems"));
  EXPECT_THAT(describe_mismatch(-3600), HasSubstr("before the IMU, whole hours"));
  EXPECT_THAT(describe_mismatch(kSecondsPerDay + 20), HasSubstr("whole days"));
  EXPECT_THAT(describe_mismatch(7 * kSecondsPerDay), HasSubstr("another GPS week"));
  EXPECT_THAT(describe_mismatch(1024.0 * 7 * kSecondsPerDay), HasSubstr("rollover"));
  EXPECT_THAT(describe_mismatch(315'964'800),
              HasSubstr("the epochs of GPS (1980) and UNIX (1970)"));
}

}  // namespace
}  // namespace foucault
