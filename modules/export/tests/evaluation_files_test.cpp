#include "foucault/export/evaluation_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/drifting_experiment.h"
#include "support/test_folder.h"

namespace foucault::exports {
namespace {

TEST(EvaluationFiles, HoldTheSummary) {
  const test::TestFolder folder;
  const std::vector<evaluation::ExperimentResult> results =
      evaluation::run_experiments(test::drifting_runs(), 2);
  DriftFile drifts(folder.path() / "drift.csv");
  for (const evaluation::ExperimentResult& result : results) drifts.add(result);
  drifts.close();
  const evaluation::EvaluationSummary summary(results);
  write_evaluation(summary, {"foucault evaluate", "imu: {}\n", "1"}, folder.path());

  const auto json = nlohmann::json::parse(folder.text("metrics.json"));
  EXPECT_EQ(json["methods"]["good"]["outages"], 12);
  EXPECT_NEAR(json["methods"]["good"]["horizontal_rmse_m"], 9, 0.5);
  EXPECT_TRUE(json["methods"]["good"]["horizontal_rms_m_after_s"].contains("30"));
  EXPECT_FALSE(json["methods"]["good"]["horizontal_rms_m_after_s"].contains("60"));
  EXPECT_EQ(json["recordings"].size(), 3u);
  EXPECT_EQ(json["comparisons"].size(), 3u);
  EXPECT_EQ(json["comparisons"][0]["base"], "good");
  EXPECT_NEAR(json["comparisons"][0]["horizontal"]["relative"]["value"], 1, 0.05);
  EXPECT_EQ(json["runs"].size(), 8u);
  EXPECT_EQ(json["runs"][0]["truth"], "reference");
  EXPECT_EQ(json["version"], "1");
  EXPECT_EQ(folder.text("config.yaml"), "imu: {}\n");
  EXPECT_EQ(folder.lines("drift.csv").size(), 1u + 2 * 12);
  EXPECT_FALSE(folder.text("tables/table_iii.md").empty());
  EXPECT_EQ(folder.text("tables/distance.csv"), "") << "nothing is far from the start";
}

/// As if the outages lay on the way out.
TEST(EvaluationFiles, DistancesOfATripThatGoesFar) {
  const test::TestFolder folder;
  std::vector<evaluation::ExperimentResult> results =
      evaluation::run_experiments(test::drifting_runs(), 2);
  for (evaluation::ExperimentResult& result : results) {
    result.imu = result.recording;
    double distance_m = 0;
    for (evaluation::OutageDrift& drift : result.run.drifts) drift.distance_m = distance_m += 20e3;
  }
  const evaluation::EvaluationSummary summary(results);
  write_evaluation(summary, {"", "", "1"}, folder.path());
  const auto json = nlohmann::json::parse(folder.text("metrics.json"));
  EXPECT_EQ(json["imus"].size(), 2u);
  ASSERT_EQ(json["distances"].size(), 2u);
  const auto& bin = json["distances"][0]["bins"][0]["methods"];
  EXPECT_EQ(bin["good"]["horizontal_relative"]["value"], 0);
  EXPECT_NEAR(bin["bad"]["horizontal_relative"]["value"], 1, 0.05);
  EXPECT_FALSE(folder.text("tables/distance_difference.md").empty());
  EXPECT_EQ(folder.text("config.yaml"), "");
}

}  // namespace
}  // namespace foucault::exports
