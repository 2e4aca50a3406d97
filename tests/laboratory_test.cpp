#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/test_folder.h"

/// `lab` of the built program.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Laboratory, WritesTableMetricsAndReport) {
  const TestFolder folder;
  const Outcome outcome =
      foucault({"lab", "preintegration", "--motion", "airliner", "--out", folder / "lab"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Airliner at cruise"));

  const nlohmann::json airliner =
      nlohmann::json::parse(folder.text("lab/metrics.json")).at("motions").at("airliner");
  const auto position = [&](const char* model) {
    return airliner.at("models").at(model).at("1").at("position_rms_m").get<double>();
  };
  EXPECT_LT(position("full"), 1e-6);
  EXPECT_NEAR(position("full"), position("discretization"), 0.01 * position("discretization"));
  EXPECT_GT(position("refined"), 0.1);
  EXPECT_GT(airliner.at("without").at("coriolis").at("1").at("position_rms_m"), 0.01);

  const std::vector<std::string> rows = folder.lines("lab/preintegration.csv");
  ASSERT_GT(rows.size(), 500u);
  EXPECT_EQ(rows[0],
            "motion,group,name,imu_rate_hz,duration_s,origin_distance_km,intervals,"
            "position_rms_m,velocity_rms_m_s,attitude_rms_rad");
  EXPECT_TRUE(fs::exists(folder / "lab/report/index.html"));
  EXPECT_TRUE(fs::exists(folder / "lab/report/lab_models_position.png"));
  EXPECT_EQ(folder.entries(), 1u);
}

/// A worker computes, the merge writes what one process would.
TEST(Laboratory, FaultsComeFromAStore) {
  const TestFolder folder;
  const std::vector<std::string> study{"lab", "faults", "--fault", "ramp", "--methods", "ekf"};
  const auto with = [&](std::vector<std::string> options) {
    options.insert(options.begin(), study.begin(), study.end());
    return foucault(options);
  };
  ASSERT_EQ(with({"--out", folder / "alone"}).exit_code, 0);
  EXPECT_EQ(folder.entries(), 1u) << "the hidden store is gone";
  const std::string store = folder / "store", out = folder / "out";
  ASSERT_EQ(with({"--out", out, "--store", store, "--shard", "1/2"}).exit_code, 0);
  EXPECT_EQ(folder.text("out/faults.csv"), "") << "workers write no results";
  const Outcome merged = with({"--out", out, "--store", store, "--no-compute"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, HasSubstr("0 runs computed, 1 found"));
  EXPECT_EQ(folder.lines("out/faults.csv").size(), 2u);
  EXPECT_EQ(folder.text("out/faults.csv"), folder.text("alone/faults.csv"));
  EXPECT_EQ(folder.text("out/faults.md"), folder.text("alone/faults.md"));
}

TEST(Laboratory, RefusesWhatItDoesNotKnow) {
  const TestFolder folder;
  const Outcome motion =
      foucault({"lab", "preintegration", "--motion", "boat", "--out", folder / "lab"});
  EXPECT_EQ(motion.exit_code, 2);
  EXPECT_THAT(motion.err, StartsWith("foucault: error: motion 'boat' is unknown; choose one of"));
  EXPECT_EQ(foucault({"lab"}).exit_code, 2);
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace foucault::test
