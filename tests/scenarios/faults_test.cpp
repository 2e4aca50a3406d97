/// Faults of recordings, on simulated trips: survived, named, or refused in words.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "fault_study.h"

namespace foucault::app {
namespace {

using ::testing::HasSubstr;

FaultOutcome run(const std::string& fault, const std::string& method, int64_t seed = 1) {
  return run_fault(find_fault_case(fault), method, Settings(), seed);
}

class Faults : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Faults, ::testing::Values("ekf", "refined", "full"));

TEST_P(Faults, OutliersHardlyMatter) {
  for (const int64_t seed : {1, 2, 3}) {
    const FaultOutcome clean = run("none", GetParam(), seed);
    const FaultOutcome outliers = run("outliers", GetParam(), seed);
    ASSERT_EQ(outliers.exit_code, 0) << outliers.message;
    EXPECT_LT(outliers.rms_m, 1.3 * clean.rms_m) << seed;
    EXPECT_GT(outliers.rejected, 25) << seed;  // 46 in the mean, 3 sigmas
    EXPECT_EQ(clean.rejected, 0) << seed;
    EXPECT_EQ(clean.message, "");
  }
}

/// 60 s without GNSS cost metres with this IMU; what the drifting fixes still tell holds it.
TEST_P(Faults, ADriftOfTheFixesIsNotFollowed) {
  for (const int64_t seed : {1, 2, 3}) {
    const FaultOutcome outcome = run("ramp", GetParam(), seed);
    EXPECT_LT(outcome.largest_m, 2) << seed;
    EXPECT_THAT(outcome.message, HasSubstr("drift")) << seed;
    ASSERT_TRUE(outcome.recovery_s.has_value()) << seed;
    EXPECT_LT(*outcome.recovery_s, 10) << seed;
  }
}

TEST_P(Faults, AJumpIsBelievedOnlyIfItStays) {
  const FaultOutcome away = run("jump", GetParam());
  EXPECT_LT(away.largest_m, 2);
  const FaultOutcome back = run("jump_back", GetParam());
  EXPECT_GT(back.largest_m, 99);  // the first half of the recording is wrong, and consistent
  ASSERT_TRUE(back.recovery_s.has_value());
  EXPECT_LT(*back.recovery_s, 40);
  EXPECT_THAT(back.message, HasSubstr("off by"));
}

/// Those from which a method comes out as good as without them.
TEST_P(Faults, OthersLeaveCentimetres) {
  for (const char* fault : {"sigma_small", "duplicate", "swapped", "another_week", "imu_gap_sample",
                            "imu_gap_3s", "imu_gap_60s", "imu_duplicate", "imu_jitter", "imu_nan",
                            "imu_clipped", "imu_stuck", "imu_half_rate"}) {
    const FaultOutcome outcome = run(fault, GetParam());
    EXPECT_EQ(outcome.exit_code, 0) << fault << ": " << outcome.message;
    EXPECT_LT(outcome.rms_m, 0.02) << fault;
    EXPECT_LT(outcome.largest_m, 0.3) << fault;
    EXPECT_TRUE(outcome.recovery_s.has_value()) << fault;
  }
}

/// As good as 60 s without GNSS, with this IMU.
TEST_P(Faults, FixesThatCannotBeUsedAreAnOutage) {
  for (const char* fault : {"sigma_zero", "sigma_negative", "sigma_nan", "late"}) {
    const FaultOutcome outcome = run(fault, GetParam());
    EXPECT_EQ(outcome.rejected, 60) << fault;
    EXPECT_LT(outcome.largest_m, 10) << fault;
    ASSERT_TRUE(outcome.recovery_s.has_value()) << fault;
    EXPECT_LT(*outcome.recovery_s, 3) << fault;
    EXPECT_NE(outcome.message, "") << fault;
  }
}

TEST_P(Faults, UselessRecordingsAreRefusedInWords) {
  const std::map<std::string, std::string> expected{
      {"gyro_deg", "deg/s"}, {"accel_g", "in g"},  {"axes", "gravity points"},
      {"gps_utc", "18"},     {"week", "rollover"}, {"no_overlap", "do not overlap"}};
  for (const auto& [fault, words] : expected) {
    const FaultOutcome outcome = run(fault, GetParam());
    EXPECT_EQ(outcome.exit_code, 1) << fault;
    EXPECT_THAT(outcome.message, HasSubstr(words)) << fault;
  }
}

}  // namespace
}  // namespace foucault::app
