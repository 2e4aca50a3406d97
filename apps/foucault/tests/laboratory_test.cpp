#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "jobs/demo_job.h"
#include "jobs/laboratory_job.h"
#include "jobs/simulation_job.h"
#include "pages/laboratory_page.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

TEST(DemoJob, CasesHaveTheSettingsOfTheirImu) {
  const laboratory::PaperExperiment experiment{{60}};
  EXPECT_EQ(demo_run(experiment, "x").log, "x/ADIS16465-60s.rawlog");
  const std::vector<EvaluationCase> plain =
      evaluation_cases(laboratory::cases_as_simulated(experiment), "x");
  ASSERT_EQ(plain.size(), 16u);
  EXPECT_EQ(plain[0].log, "x/ICM20602-60s.rawlog");
  EXPECT_EQ(plain[0].settings->imu.preset, "ICM20602");
  EXPECT_FALSE(plain[0].settings->imu.arw_deg_sqrt_h.has_value());
  EXPECT_EQ(plain[0].settings->gnss.gate_false_alarm, 0);
  const std::vector<EvaluationCase> tuned =
      evaluation_cases(laboratory::cases_tuned(experiment), "x");
  EXPECT_EQ(tuned[0].settings->imu.arw_deg_sqrt_h, 0.25);
}

TEST(LaboratoryJob, AReturnOnARecording) {
  const test::TestFolder folder;
  Console quiet(true);
  SimulationSettings trip;
  trip.scenario.duration_s = 150;
  trip.scenario.imu_rate_hz = 50;
  write_simulation(trip, folder / "trip.rawlog", quiet);
  Settings settings;
  settings.outages.first_s = 100;
  settings.outages.shifts_s = {0};
  const laboratory::ReturnOutcome outcome =
      study_return({folder / "trip.rawlog", 1, 10, "ekf"}, settings);
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.outages, 1);
  EXPECT_EQ(study_return({folder / "none", 1, 10, "ekf"}, settings).outages, 0);
}

class Starts : public ::testing::TestWithParam<int64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Starts, ::testing::Values(1, 6, 11, 16));

/// Of `foucault lab starts`, five each.
TEST_P(Starts, AreRightWhereTheDataTellTheHeading) {
  double squares = 0;
  std::size_t headings = 0;
  for (int64_t seed = GetParam(); seed < GetParam() + 5; ++seed) {
    const laboratory::StartOutcome outcome = study_start(seed, Settings());
    EXPECT_TRUE(outcome.is_right()) << seed << ' ' << outcome.what << ' ' << outcome.refusal;
    for (const auto& h : outcome.headings) squares += std::pow(h.error / h.sigma, 2);
    headings += outcome.headings.size();
  }
  EXPECT_GE(headings, 15u);
  EXPECT_LT(squares / static_cast<double>(headings), 3);
}

TEST(LaboratoryPage, CurvesOfEveryMotion) {
  laboratory::StudyResult result;
  result.plan.durations_s = {1, 60};
  result.plan.rates_hz = {200};
  result.plan.fine_rates_hz = {1000};
  result.plan.origin_distances_km = {0, 1};
  result.plan.grades = {"ADIS16465", "navigation"};
  const laboratory::PreintegrationStudy study(laboratory::lab_motion("vibration"), result.plan);
  result.motions.push_back(study.summarize({study.measure(0)}));
  const content::LaboratoryReport report = laboratory_report(result);
  ASSERT_EQ(report.motions.size(), 1u);
  EXPECT_EQ(report.motions[0].rates.size(), 3u) << "full, no coning, no sculling";
  EXPECT_EQ(report.motions[0].small_noise.size(), 1u);
  EXPECT_EQ(report.term_tables.size(), 1u);
  EXPECT_EQ(report.key_numbers.size(), 1u);
}

}  // namespace
}  // namespace foucault::app
