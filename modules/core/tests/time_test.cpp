#include "foucault/core/time.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace foucault {
namespace {

constexpr int64_t kSecond = kNanosecondsPerSecond;

// 2016-12-31T23:59:59 UTC; a leap second followed.
constexpr int64_t kBeforeLeap = 1483228799 * kSecond;

TEST(Time, GpsEpochIsThe6thOfJanuary1980) {
  EXPECT_EQ(gps_to_unix_ns(0, 0.0), 315964800 * kSecond);
  EXPECT_EQ(unix_to_gps(315964800 * kSecond).week, 0);
  EXPECT_EQ(unix_to_gps(315964800 * kSecond).tow_ns, 0);
}

TEST(Time, Week2200) {
  // 2022-03-06T00:00:00 GPS is the start of week 2200; 357000 s later it is Thursday
  // 2022-03-10T03:10:00 GPS, 18 s earlier in UTC.
  EXPECT_EQ(gps_to_unix_ns(2200, 357000.0), 1646881782 * kSecond);
  EXPECT_EQ(gps_to_unix_ns(2200, 357000.125), 1646881782 * kSecond + 125'000'000);
}

TEST(Time, SecondOfWeekIsExactToTheNanosecond) {
  EXPECT_EQ(gps_to_unix_ns(2200, 604799.999999999), gps_to_unix_ns(2201, 0.0) - 1);
  EXPECT_EQ(gps_to_unix_ns(2200, 357000.123456789), 1646881782 * kSecond + 123'456'789);
}

TEST(Time, SecondOfWeekMayLieOutsideTheWeek) {
  EXPECT_EQ(gps_to_unix_ns(2200, -0.5), gps_to_unix_ns(2199, 604799.5));
  EXPECT_EQ(gps_to_unix_ns(2200, 604800.25), gps_to_unix_ns(2201, 0.25));
  EXPECT_EQ(gps_to_unix_ns(GpsTime{2200, -kSecond}), gps_to_unix_ns(2199, 604799.0));
}

TEST(Time, OffsetByDate) {
  // `date -u -d 1981-07-01 +%s` and so on, for each line of tzdata's leapseconds after 1980.
  const std::vector<int64_t> steps{362793600,  394329600,  425865600, 489024000,  567993600,
                                   631152000,  662688000,  709948800, 741484800,  773020800,
                                   820454400,  867715200,  915148800, 1136073600, 1230768000,
                                   1341100800, 1435708800, 1483228800};
  EXPECT_EQ(gps_utc_offset_s(0), 0);
  int offset = 0;
  for (const int64_t step : steps) {
    EXPECT_EQ(gps_utc_offset_s(step * kSecond - 1), offset) << step;
    EXPECT_EQ(gps_utc_offset_s(step * kSecond), ++offset) << step;
  }
  EXPECT_EQ(gps_utc_offset_s(std::numeric_limits<int64_t>::max()), 18);
}

TEST(Time, AcrossTheLeapSecondOf2016) {
  const GpsTime before = unix_to_gps(kBeforeLeap);
  const GpsTime after = unix_to_gps(kBeforeLeap + kSecond);
  EXPECT_EQ(after.week, before.week);
  EXPECT_EQ(after.tow_ns - before.tow_ns, 2 * kSecond);  // 23:59:60 lies between

  const GpsTime last{before.week, before.tow_ns + kSecond - 1};
  const GpsTime inserted{before.week, before.tow_ns + kSecond + kSecond / 2};
  EXPECT_EQ(gps_to_unix_ns(last), kBeforeLeap + kSecond - 1);
  EXPECT_EQ(gps_to_unix_ns(after), kBeforeLeap + kSecond);
  // The UNIX scale has no name for the inserted second and counts it twice.
  EXPECT_EQ(gps_to_unix_ns(inserted), kBeforeLeap + kSecond + kSecond / 2);
}

TEST(Time, RoundTripIsExact) {
  std::mt19937_64 rng{42};
  std::uniform_int_distribution<int64_t> any(0, 4'000'000'000 * kSecond);
  for (int i = 0; i < 100'000; ++i) {
    const int64_t t_ns = any(rng);
    const GpsTime gps = unix_to_gps(t_ns);
    ASSERT_GE(gps.tow_ns, 0);
    ASSERT_LT(gps.tow_ns, 604800 * kSecond);
    ASSERT_EQ(gps_to_unix_ns(gps), t_ns);
  }
}

TEST(Time, TextOfAStamp) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(clock_text(1'751'999'999'999'999'999),
            "2025-07-08T18:39:59.999Z, GPS week 2374 240017.999 s")
      << "both are cut off, so that they are one moment";
  EXPECT_EQ(utc_text(1'751'999'999'999'999'999), "2025-07-08T18:39:59.999Z");
  EXPECT_EQ(utc_text(-1), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(utc_text(-1'500'000'000), "1969-12-31T23:59:58.500Z");
  EXPECT_EQ(utc_text(std::numeric_limits<int64_t>::min()).substr(0, 4), "1677");
}

TEST(Time, NanosecondsRoundToNearest) {
  EXPECT_EQ(nanoseconds(0.1), 100'000'000);
  EXPECT_EQ(nanoseconds(-0.1), -100'000'000);
  EXPECT_EQ(nanoseconds(-1e-9), -1);
  EXPECT_EQ(nanoseconds(4e-10), 0);
  EXPECT_EQ(nanoseconds(6e-10), 1);
  EXPECT_EQ(nanoseconds(1646881782.5), 1646881782'500'000'000);
  EXPECT_EQ(seconds_between(5, 1'500'000'005), 1.5);
  EXPECT_EQ(seconds_between(0, 60 * kSecond), 60);  // 60.00000000000001 by a product with 1e-9
}

TEST(Time, NanosecondsRefuseWhatDoesNotFit) {
  EXPECT_THROW(nanoseconds(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(nanoseconds(std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(nanoseconds(1e10), std::invalid_argument);
}

}  // namespace
}  // namespace foucault
