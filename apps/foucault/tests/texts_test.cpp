#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "foucault/core/so3.h"
#include "foucault/state/blocks.h"
#include "pages/run_page.h"
#include "texts/check_text.h"
#include "texts/profile_text.h"
#include "texts/rawlog_summary.h"
#include "texts/run_text.h"

namespace foucault::app {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A log in which everything that can be told is there.
rawlog::RawlogInfo troubled_log() {
  rawlog::RawlogInfo info;
  info.path = "trip.rawlog";
  info.compressed = info.sensory_frames = true;
  info.imu_label = "IMU";
  info.mounting.emplace().q_v_b = so3::from_euler({0, 0, M_PI / 2});
  info.imu_not_finite = 3;
  info.damage = "breaks off";
  info.other_records["CActionCollection"] = 4;
  rawlog::StreamInfo imu;
  imu.label = "IMU";
  imu.last_ns = 10'000'000'000;
  imu.median_interval = 0.01;
  imu.burst_samples = 4;
  imu.backward = imu.without_stamp = 1;
  imu.gap_count = 1;
  imu.longest_gaps = {{2'000'000'000, 0.5}};
  rawlog::StreamInfo gnss;
  gnss.label = "GNSS";
  gnss.duplicates = 2;
  info.streams = {imu, gnss};
  rawlog::GnssInfo receiver;
  receiver.label = "GNSS";
  receiver.not_finite = receiver.bad_sigma = 1;
  receiver.p_v = Eigen::Vector3d(0.1, -0.3, -0.8);
  for (const FixQuality quality :
       {FixQuality::unknown, FixQuality::single, FixQuality::differential, FixQuality::ppp,
        FixQuality::float_rtk, FixQuality::fixed_rtk}) {
    receiver.qualities[quality] = 1;
  }
  info.receivers = {receiver};
  return info;
}

TEST(RawlogSummary, TellsWhatIsWrong) {
  const std::string text = rawlog_text(troubled_log());
  for (const char* part :
       {"damaged: breaks off", "3 IMU samples are not finite", "IMU: 1 stamps go back",
        "in bursts of 4.0; they are made even, 10 ms apart", "GNSS: 2 stamps repeat",
        "1 observations have no stamp", "1 fixes are not finite", "1 fixes with a sigma",
        "1 gaps; the longest: 0.500 s at +2.0 s", "1 float_rtk", "heading 90.00 deg",
        "lever arm forward 0.100", "skipped 4 records of CActionCollection"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  const auto json = nlohmann::json::parse(rawlog_json(troubled_log()));
  EXPECT_EQ(json["health"].size(), 8u);
  EXPECT_EQ(json["streams"][0]["rate_hz"], 100);
  EXPECT_EQ(json["gnss"][0]["lever_arm_m"][2], -0.8);
  EXPECT_EQ(json["imu"]["label"], "IMU");
}

TEST(RawlogSummary, AnEmptyLog) {
  EXPECT_THAT(rawlog_text({}), AllOf(HasSubstr("no IMU"), HasSubstr("no GNSS receiver")));
  EXPECT_FALSE(nlohmann::json::parse(rawlog_json({}))["imu"].contains("mounting_rpy_deg"));
}

TEST(ProfileText, ALineAStageAndTheirSum) {
  EXPECT_TRUE(profile_lines({}).empty());
  std::vector<StageTime> profile;
  for (std::size_t i = 0; i < kStages; ++i) profile.push_back({static_cast<Stage>(i), 1, 1});
  const std::vector<std::string> lines = profile_lines(profile);
  ASSERT_EQ(lines.size(), kStages + 1);
  EXPECT_THAT(lines[1], AllOf(HasSubstr("survey"), HasSubstr("gone through before")));
  EXPECT_THAT(lines[2], AllOf(HasSubstr("read"), HasSubstr("log to measurements")));
  EXPECT_THAT(lines.back(), HasSubstr("16.000 s"));
}

RunResult some_result() {
  RunResult result;
  result.method = "ekf";
  result.metrics.trust.trustworthy = true;
  result.metrics.gnss.samples = result.metrics.gnss.used = 10;
  result.metrics.consistency.nis.samples = 10;
  result.metrics.consistency.nis.mean = 3;
  result.metrics.aids["wheel_speed"] = {1, 2, 0, 2.0};
  evaluation::ReferenceMetrics reference;
  reference.roll_rmse = reference.pitch_rmse = reference.heading_rmse = 0.01;
  reference.position_inside.samples = 1;
  reference.position_inside.fraction.setOnes();
  result.metrics.reference = reference;
  result.calibration = {{state::block::gyro_bias, {1, 2, 3}, {1, 1, 1}}};
  result.profile = {{Stage::read, 1, 1}};
  result.damage = "breaks off";
  result.resources.wall_s = 1;
  return result;
}

TEST(RunText, ForProgramsAndForPeople) {
  const auto json = nlohmann::ordered_json::parse(metrics_json(some_result()));
  EXPECT_EQ(json.begin().key(), "method");
  EXPECT_EQ(json["profile"]["read_s"], 1);
  EXPECT_EQ(json["damage"], "breaks off");
  EXPECT_TRUE(json["trustworthy"]);
  const std::vector<std::string> lines = metrics_lines(some_result());
  EXPECT_THAT(lines, Contains(HasSubstr("wheel_speed: 2 used")));
  EXPECT_THAT(lines, Contains(HasSubstr("calibrated gyro_bias")));
  EXPECT_THAT(lines, Contains(HasSubstr("; roll 0.573, pitch 0.573")));

  RunResult bare;
  bare.metrics.reference.emplace();
  EXPECT_THAT(metrics_lines(bare), Contains(HasSubstr("north / east / down -")));
  EXPECT_THAT(metrics_lines(bare), Contains(AllOf(HasSubstr("reference"), Not(HasSubstr("roll")))));
  EXPECT_FALSE(nlohmann::json::parse(metrics_json(bare)).contains("damage"));
  bare.metrics.reference.reset();
  bare.metrics.reference_elsewhere_m = 62854;
  EXPECT_THAT(metrics_lines(bare), Contains(HasSubstr("of another place, 62.85 km away")));
  EXPECT_EQ(nlohmann::json::parse(metrics_json(bare))["reference_elsewhere_m"], 62854);
}

TEST(RunText, Verdicts) {
  RunResult result = some_result();
  EXPECT_THAT(verdict_line(result), HasSubstr("trustworthy; innovations of 10 fixes are 1.00"));
  EXPECT_FALSE(verdict_banner(result).lines.empty());
  result.metrics.trust.reasons = {"named"};
  EXPECT_THAT(verdict_line(result), HasSubstr("trustworthy; named"));
  EXPECT_THAT(verdict_banner(result).lines, testing::ElementsAre("named"));
  result.metrics.trust.trustworthy = false;
  EXPECT_THAT(verdict_line(result), HasSubstr("NOT TRUSTWORTHY: named"));
  EXPECT_THAT(verdict_banner(result).title, HasSubstr("cannot be believed"));
  result.metrics.reference->position_inside.fraction.setConstant(0.575);
  EXPECT_THAT(verdict_banner(result).lines.back(),
              AllOf(HasSubstr("57.5 %"), HasSubstr("against the reference")));
  EXPECT_THAT(verdict_line(result), HasSubstr("; yet against the reference only 57.5 %"));
  EXPECT_THAT(nlohmann::json::parse(metrics_json(result))["against_reference"],
              HasSubstr("57.5 %"));
  result.metrics.reference->position_inside.fraction.setConstant(0.99);
  EXPECT_THAT(verdict_line(result), Not(HasSubstr("reference")));
  EXPECT_FALSE(nlohmann::json::parse(metrics_json(result)).contains("against_reference"));
}

TEST(RunPage, ATableForWhatThereIs) {
  EXPECT_EQ(metrics_tables(some_result()).size(), 3u);  // calibration and aids have sections
  EXPECT_EQ(metrics_tables({}).size(), 1u) << "the summary";
}

/// The same rule as under Calibration and in `check`.
TEST(RunPage, ALeverArmThatTheRecordingHardlyTellsSaysSo) {
  RunResult result;
  result.calibration = {{state::block::lever_arm, {0.1, -0.3, -0.8}, {0.002, 0.034, 0.036}}};
  result.told = {{state::block::lever_arm, {0.1, -0.3, -0.8}, {0.05, 0.05, 0.05}}};
  const std::vector<page::Table> tables = metrics_tables(result);
  std::string arm;
  for (const std::vector<std::string>& row : tables.at(0).rows) {
    if (row[0] == "Lever arm, IMU to antenna") arm = row[1];
  }
  EXPECT_EQ(arm,
            "estimated: forward 0.100 ± 0.002 m, right -0.300 ± 0.034 m, down -0.800 ± 0.036 m "
            "(hardly told by the recording)");
  EXPECT_EQ(key_numbers(some_result()).size(), 6u);
  EXPECT_EQ(key_numbers({}).size(), 3u);
}

TEST(CheckText, TellsWhatMustBeMended) {
  using diagnosis::Severity;
  const std::vector<diagnosis::Finding> findings{
      {Severity::ok, "sigmas", "0.01 m", ""},
      {Severity::error, "gravity", "mean 1.00 m/s^2", "name the unit"}};
  EXPECT_EQ(subjects_to_mend(findings), std::vector<std::string>{"gravity"});
  EXPECT_THAT(findings_text(findings), HasSubstr("-> name the unit"));
  const nlohmann::json json = nlohmann::json::parse(findings_json("a.rawlog", findings));
  EXPECT_FALSE(json["ok"].get<bool>());
  EXPECT_EQ(json["findings"][1]["remedy"], "name the unit");
  EXPECT_TRUE(nlohmann::json::parse(findings_json("a", {findings[0]}))["ok"].get<bool>());
}

}  // namespace
}  // namespace foucault::app
