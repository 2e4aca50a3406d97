#include "foucault/laboratory/paper_experiment.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "foucault/laboratory/preintegration_output.h"
#include "support/test_folder.h"

namespace foucault::laboratory {
namespace {

TEST(PaperExperiment, EveryImuOnEveryTrip) {
  const PaperExperiment experiment{{100, 200}};
  const std::vector<PaperRecording> all = recordings(experiment);
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all[0].name, "ICM20602-100s");
  EXPECT_EQ(all[3].seed, all[0].seed) << "one trip, four IMUs";
  EXPECT_EQ(all[4].seed, all[0].seed + 1);

  const std::vector<PaperCase> plain = cases_as_simulated(experiment);
  EXPECT_EQ(plain.size(), 8u * 4);
  for (const PaperCase& c : plain) EXPECT_FALSE(c.noise.has_value());
  const std::vector<PaperCase> tuned = cases_tuned(experiment);
  EXPECT_EQ(tuned.size(), 8u * 3);
  for (const PaperCase& c : tuned) {
    ASSERT_TRUE(c.noise.has_value());
    EXPECT_EQ(c.noise->gyro_bias_deg_h > 100, c.method == "rough");
  }
}

/// Two intervals of one motion with everything that the tables show.
TEST(PreintegrationOutput, TablesAndFilesHoldTheStudy) {
  StudyResult result;
  result.plan.durations_s = {1, 60};
  result.plan.rates_hz = {200};
  result.plan.fine_rates_hz = {1000};
  result.plan.origin_distances_km = {0, 1};
  result.plan.grades = {"ADIS16465"};
  result.version = "1";
  const PreintegrationStudy study(lab_motion(lab_motion_names().front()), result.plan);
  result.motions.push_back(study.summarize({study.measure(0), study.measure(1)}));

  EXPECT_EQ(model_table(result).rows.size(), 2u);
  EXPECT_EQ(discretization_table(result).rows.size(), 2u);
  const evaluation::TextTable terms = term_table(result, result.motions[0]);
  EXPECT_EQ(terms.header.size(), 2u);
  EXPECT_EQ(terms.rows.size(), lab_ablations().size() + lab_models().size() - 1);
  EXPECT_EQ(laboratory_lines(result).size(), 4u) << "title, header, two rows";

  const test::TestFolder folder;
  write_laboratory(result, folder.path());
  EXPECT_EQ(folder.lines("preintegration.csv").size(), 1 + result.motions[0].rows.size());
  const auto json = nlohmann::json::parse(folder.text("metrics.json"));
  const auto& models = json["motions"][result.motions[0].name]["models"];
  EXPECT_LT(models["full"]["1"]["position_rms_m"], models["rough"]["1"]["position_rms_m"]);
}

}  // namespace
}  // namespace foucault::laboratory
