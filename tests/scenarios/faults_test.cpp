/// Faults of recordings, on simulated trips, through rawlogs: survived, named, or refused in words.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "jobs/laboratory_job.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

using namespace laboratory;

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::vector<std::string> kMethods{"ekf", "refined", "full"};

class Faults : public ::testing::Test {
 protected:
  std::vector<laboratory::FaultOutcome> run(const std::string& fault, int64_t seed = 1) const {
    return app::run_fault(laboratory::find_fault_case(fault), kMethods, Settings(), seed,
                          folder_ / (fault + ".rawlog"));
  }

  test::TestFolder folder_;
};

TEST_F(Faults, OutliersHardlyMatter) {
  for (const int64_t seed : {1, 2, 3}) {
    const std::vector<laboratory::FaultOutcome> clean = run("none", seed),
                                                outliers = run("outliers", seed);
    for (std::size_t i = 0; i < kMethods.size(); ++i) {
      ASSERT_EQ(outliers[i].exit_code, 0) << outliers[i].message;
      EXPECT_LT(outliers[i].rms_m, 1.3 * clean[i].rms_m) << kMethods[i] << seed;
      EXPECT_GT(outliers[i].rejected, 25) << seed;  // 46 in the mean, 3 sigmas
      EXPECT_TRUE(outliers[i].trust->trustworthy) << seed;
      EXPECT_EQ(clean[i].rejected, 0) << seed;
      EXPECT_EQ(clean[i].message, "");
    }
  }
}

/// 60 s without GNSS cost metres with this IMU; what the drifting fixes still tell holds it.
TEST_F(Faults, ADriftOfTheFixesIsNotFollowed) {
  for (const int64_t seed : {1, 2, 3}) {
    for (const laboratory::FaultOutcome& outcome : run("ramp", seed)) {
      EXPECT_LT(outcome.largest_m, 2) << outcome.method << seed;
      EXPECT_THAT(outcome.message, HasSubstr("drift")) << seed;
      ASSERT_TRUE(outcome.recovery_s.has_value()) << seed;
      EXPECT_LT(*outcome.recovery_s, 10) << seed;
    }
  }
}

/// Slower than the gate sees: it is followed, but what is true again is believed within seconds.
TEST_F(Faults, AFollowedDriftIsLeftAtOnce) {
  for (const laboratory::FaultOutcome& outcome : run("ramp_coarse")) {
    EXPECT_LT(outcome.largest_m, 25) << outcome.method;
    EXPECT_LT(outcome.rms_m, 6) << outcome.method;  // 20 when the way back is taken for a drift
    ASSERT_TRUE(outcome.recovery_s.has_value());
    EXPECT_LT(*outcome.recovery_s, 15);
  }
}

TEST_F(Faults, AJumpIsBelievedOnlyIfItStays) {
  for (const laboratory::FaultOutcome& away : run("jump")) EXPECT_LT(away.largest_m, 2);
  for (const laboratory::FaultOutcome& back : run("jump_back")) {
    EXPECT_GT(back.largest_m, 99);  // the first half of the recording is wrong, and consistent
    ASSERT_TRUE(back.recovery_s.has_value());
    EXPECT_LT(*back.recovery_s, 40);
    EXPECT_THAT(back.message, HasSubstr("off by"));
  }
}

/// Those from which a method comes out as good as without them.
TEST_F(Faults, OthersLeaveCentimetres) {
  for (const char* fault :
       {"sigma_small", "duplicate", "late", "swapped", "another_week", "imu_gap_sample",
        "imu_gap_3s", "imu_gap_60s", "imu_duplicate", "imu_backward", "imu_jitter", "imu_nan",
        "imu_clipped", "imu_stuck", "imu_half_rate", "imu_interpolated"}) {
    for (const laboratory::FaultOutcome& outcome : run(fault)) {
      EXPECT_EQ(outcome.exit_code, 0) << fault << ": " << outcome.message;
      EXPECT_LT(outcome.rms_m, 0.02) << fault;
      EXPECT_LT(outcome.largest_m, 0.3) << fault;
      EXPECT_TRUE(outcome.recovery_s.has_value()) << fault;
      EXPECT_EQ(outcome.trust->trustworthy, std::string(fault) != "sigma_small") << fault;
    }
  }
}

TEST_F(Faults, BurstsAreMadeEvenAndNamed) {
  for (const laboratory::FaultOutcome& outcome : run("imu_bursts")) {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.message;
    EXPECT_LT(outcome.rms_m, 0.02) << outcome.method;
    EXPECT_LT(outcome.largest_m, 0.3) << outcome.method;
    EXPECT_THAT(outcome.message, HasSubstr("stamped on arrival"));
  }
}

TEST_F(Faults, SigmasThatAreTooSmallAreNamed) {
  for (const laboratory::FaultOutcome& outcome : run("sigma_small")) {
    EXPECT_THAT(outcome.message, HasSubstr("times as large as their sigmas")) << outcome.method;
  }
}

/// As good as 60 s without GNSS, with this IMU.
TEST_F(Faults, FixesThatCannotBeUsedAreAnOutage) {
  for (const char* fault : {"sigma_zero", "sigma_negative", "sigma_nan"}) {
    for (const laboratory::FaultOutcome& outcome : run(fault)) {
      EXPECT_EQ(outcome.exit_code, 0) << fault;
      EXPECT_LT(outcome.largest_m, 10) << fault;
      ASSERT_TRUE(outcome.recovery_s.has_value()) << fault;
      EXPECT_LT(*outcome.recovery_s, 3) << fault;
      EXPECT_NE(outcome.message, "") << fault;
    }
  }
}

TEST_F(Faults, HiddenLossesAreNamedAndRecovered) {
  for (const laboratory::FaultOutcome& outcome : run("imu_splice")) {
    EXPECT_LT(outcome.largest_m, 5) << outcome.method;
    ASSERT_TRUE(outcome.recovery_s.has_value());
    EXPECT_LT(*outcome.recovery_s, 10);
    EXPECT_THAT(outcome.message, HasSubstr("contradict the IMU"));
  }
}

TEST_F(Faults, UselessRecordingsAreRefusedInWords) {
  const std::map<std::string, std::string> expected{
      {"gyro_deg", "deg/s"},      {"accel_g", "in g"},
      {"axes", "gravity points"}, {"gps_utc", "18"},
      {"week", "rollover"},       {"no_overlap", "do not overlap"},
      {"file_empty", "is empty"}, {"file_text", "no MRPT rawlog"},
  };
  for (const auto& [fault, words] : expected) {
    for (const laboratory::FaultOutcome& outcome : run(fault)) {
      EXPECT_EQ(outcome.exit_code, 1) << fault;
      EXPECT_THAT(outcome.message, HasSubstr(words)) << fault;
    }
  }
}

TEST_F(Faults, WhatComesBeforeDamageIsProcessed) {
  for (const char* fault : {"file_truncated", "file_overwritten"}) {
    for (const laboratory::FaultOutcome& outcome : run(fault)) {
      EXPECT_EQ(outcome.exit_code, 1) << fault;
      EXPECT_GT(outcome.used, 150) << fault;
      EXPECT_LT(outcome.rms_m, 0.02) << fault;
      EXPECT_THAT(outcome.message, AllOf(HasSubstr(fault), HasSubstr("byte"))) << fault;
    }
  }
}

}  // namespace
}  // namespace foucault::app
