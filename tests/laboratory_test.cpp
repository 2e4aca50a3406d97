#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

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
