#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "foucault/core/error.h"
#include "jobs/evaluation_job.h"
#include "jobs/simulation_job.h"
#include "pages/evaluation_page.h"
#include "support/drifting_experiment.h"
#include "support/table.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

/// A log of 300 s, with truth, made once for all tests.
class EvaluationTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TestFolder;
    Console console(true);
    SimulationSettings trip;
    trip.scenario.duration_s = 300;
    trip.scenario.seed = 5;
    write_simulation(trip, log(), console);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string log() { return *folder_ / "trip.rawlog"; }

  /// Outages of 20 s at 150 s, 200 s, 250 s and at 175 s, 225 s, 275 s.
  static Settings settings() {
    Settings settings;
    settings.outages.first_s = 150;
    settings.outages.length_s = 20;
    settings.outages.period_s = 50;
    settings.outages.shifts_s = {0, 25};
    return settings;
  }

  static Evaluation results(int threads, const test::TestFolder& out) {
    Console console(true);
    RunStore store(threads);
    return {evaluate(cross({log()}, {"ekf", "rough"}, settings()), store, out.path(), console)};
  }

  static test::TestFolder* folder_;
};

test::TestFolder* EvaluationTest::folder_ = nullptr;

TEST_F(EvaluationTest, SameNumbersWithOneThreadAndTwo) {
  const test::TestFolder out;
  results(1, out);
  const std::string one = out.text("drift.csv");
  results(2, out);
  EXPECT_EQ(out.text("drift.csv"), one);
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 1 + 2 * 6);
}

TEST_F(EvaluationTest, WritesWhatItFound) {
  const test::TestFolder out;
  const Evaluation evaluation = results(2, out);
  EvaluationLabels labels;
  labels.origin = {"foucault evaluate trip.rawlog", "imu: {preset: ADIS16465}\n", "1"};
  Console console(true);
  write_evaluation(evaluation, labels, false, out.path(), console);

  const auto json = nlohmann::json::parse(out.text("metrics.json"));
  for (const char* method : {"ekf", "rough"}) {
    const auto& of_method = json["methods"][method];
    EXPECT_EQ(of_method["outages"], 6) << method;
    EXPECT_GT(of_method["horizontal_rmse_m"], 0.01);
    EXPECT_LT(of_method["horizontal_rmse_m"], 20);
    EXPECT_GT(of_method["vertical_rmse_m"], 0);
    EXPECT_GT(of_method["cpu_s"], 0);
    EXPECT_LE(of_method["horizontal_m"]["rms"]["low"], of_method["horizontal_rmse_m"]);
    EXPECT_TRUE(of_method["horizontal_rms_m_after_s"].contains("20"));
    EXPECT_FALSE(of_method["horizontal_rms_m_after_s"].contains("30"));
  }
  EXPECT_EQ(json["comparisons"][0]["base"], "ekf");
  EXPECT_EQ(json["comparisons"][0]["other"], "rough");
  EXPECT_EQ(json["config"], labels.origin.config);
  EXPECT_TRUE(json.contains("version"));
  EXPECT_TRUE(json["distances"].empty()) << "nothing is far from the start";

  for (const char* name : {"tables/table_iii.csv", "tables/table_iii.md", "tables/table_iv.csv",
                           "tables/table_iv.md", "tables/statistics.csv", "config.yaml"}) {
    EXPECT_FALSE(out.text(name).empty()) << name;
  }
  const test::Table drifts(out / "drift.csv");
  EXPECT_THAT(drifts.column("length_s"), Each(20));
  EXPECT_THAT(drifts.column("outage"), ElementsAre(1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3));
  EXPECT_THAT(drifts.column("distance_km"), Each(testing::AllOf(testing::Gt(0), testing::Lt(5))));
}

/// An airliner's first minutes: outages from the runway to some 20 km.
TEST_F(EvaluationTest, DriftByDistanceOfATripThatGoesFar) {
  const test::TestFolder folder;
  Console console(true);
  SimulationSettings flight;
  flight.imu.preset = "navigation";
  flight.scenario.name = "airliner";
  flight.scenario.duration_s = 260;
  flight.scenario.imu_rate_hz = 50;
  write_simulation(flight, folder / "flight.rawlog", console);
  Settings far = settings();
  far.imu.preset = "navigation";
  far.outages.first_s = 100;
  far.outages.period_s = 30;
  far.outages.shifts_s = {0, 15};
  RunStore store(2);
  const Evaluation evaluation{evaluate(cross({folder / "flight.rawlog"}, {"ekf", "full"}, far),
                                       store, folder.path(), console)};
  const evaluation::EvaluationSummary& summary = *evaluation.summary;

  ASSERT_EQ(summary.distances().size(), 1u);
  const evaluation::DistanceProfile& profile = summary.distances()[0];
  EXPECT_EQ(profile.group, "flight");
  std::size_t outages = 0;
  for (const evaluation::ProfileBin& bin : profile.bins) outages += bin.bin.outages.size();
  EXPECT_EQ(outages, summary.overall()[0].size());
  EXPECT_GT(profile.bins.back().bin.to_km, evaluation::kFarKm);

  write_evaluation(evaluation, {}, false, folder.path(), console);
  const auto json = nlohmann::json::parse(folder.text("metrics.json"));
  const auto& first = json["distances"][0]["bins"][0];
  EXPECT_EQ(first["methods"]["ekf"]["horizontal_relative"]["value"], 0);
  EXPECT_GT(first["methods"]["full"]["horizontal_rmse_m"]["value"], 0);
  EXPECT_FALSE(folder.text("tables/distance.csv").empty());
  const test::Table drifts(folder / "drift.csv");
  EXPECT_GT(drifts.column("distance_km").back(), evaluation::kFarKm);

  const content::EvaluationReport report = evaluation_report(summary, {});
  ASSERT_EQ(report.distances.size(), 1u);
  ASSERT_EQ(report.distances[0].methods.size(), 2u);
  EXPECT_EQ(report.distances[0].methods[1].bins.size(), profile.bins.size());
  EXPECT_EQ(report.distance_tables.size(), 2u);
}

/// The report's numbers are those of metrics.json.
TEST_F(EvaluationTest, ReportHoldsAllFigures) {
  const test::TestFolder out;
  const Evaluation evaluation = results(2, out);
  const evaluation::EvaluationSummary& summary = *evaluation.summary;
  const content::EvaluationReport report = evaluation_report(summary, {});
  EXPECT_THAT(report.methods, ElementsAre("ekf", "rough"));
  ASSERT_EQ(report.rms.size(), 2u);
  EXPECT_DOUBLE_EQ(report.rms[0].horizontal_m.value,
                   evaluation::root_mean_square(summary.overall()[0].horizontal_max()));
  ASSERT_EQ(report.cases.size(), 1u);
  ASSERT_EQ(report.cases[0].methods.size(), 2u);
  EXPECT_EQ(report.cases[0].methods[0].outages.size(), 6u);
  ASSERT_EQ(report.timelines.size(), 1u);
  EXPECT_EQ(report.timelines[0].outages.size(), 3u);
  EXPECT_EQ(report.timelines[0].curves.size(), 2u);
  ASSERT_EQ(report.maps.size(), 1u);
  EXPECT_EQ(report.maps[0].estimates.size(), 2u);
  EXPECT_TRUE(report.distances.empty());
}

TEST_F(EvaluationTest, AShortLogIsToldWhatToChange) {
  Settings settings;  // the first outage ends after 570 s
  Console console(true);
  RunStore store(1);
  try {
    evaluate(cross({log()}, {"ekf"}, settings), store, test::TestFolder().path(), console);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("trip: no outage fits into its 300 s"));
    EXPECT_THAT(error.what(), HasSubstr("outages.first_s"));
  }
}

/// Each key finds one and the same record.
class OneRecord : public store::Records {
 public:
  explicit OneRecord(store::Record record) : record_(std::move(record)) {}
  bool has(const store::Key&) const override { return true; }
  std::optional<store::Record> find(const store::Key&) override { return record_; }
  void put(const store::Key&, const store::Record&) override {}

 private:
  store::Record record_;
};

/// Of this process, since forget_peak() [bytes].
double peak_memory() {
  std::ifstream status("/proc/self/status");
  double kilobytes = 0;
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return 1e3 * kilobytes;
}

void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// Two methods on recordings of their own, seven outages of 60 s at 1 Hz: a record of 25 kB.
TEST(Gather, KeepsOfARunWhatTablesNeed) {
#ifdef __SANITIZE_ADDRESS__
  // What is measured is the peak of the process; tests/run.sh without --sanitize measures it.
  GTEST_SKIP() << "the sanitizer keeps what was freed";
#endif
  constexpr std::size_t kRuns = 20'000, kOutages = 7;
  const auto record = [] {
    evaluation::OutageOptions outages;
    outages.first_s = 100;
    outages.period_s = 100;
    evaluation::ExperimentRun run = test::drifting_run("a", "good", 1, 0, 800);
    run.schedule = evaluation::OutageSchedule(outages, 0);
    run.with_track = false;
    const evaluation::Experiment one = evaluation::experiment({run});
    return one.batch.compute(0, [](double) {});
  }();
  EXPECT_GT(record.content.size(), 20'000u);
  evaluation::Experiment experiment;
  experiment.size = kRuns;
  experiment.name = [](std::size_t i) -> evaluation::RunName {
    return {fmt::format("{:06}", i / 2), "none", i % 2 == 0 ? "good" : "bad", 0};
  };
  experiment.set_batch([](std::size_t i) { return fmt::format("{}", i); });
  OneRecord records(record);
  evaluation::Executor executor(records, {});
  const test::TestFolder out;
  Console console(true);
  forget_peak();
  const double before = peak_memory();
  const Evaluation evaluation = gather(experiment, {}, executor, out.path(), console);
  write_evaluation(evaluation, {}, false, out.path(), console);
  const double grown = peak_memory() - before;
  EXPECT_EQ(evaluation.summary->overall()[0].size(), kRuns / 2 * kOutages);
  EXPECT_EQ(out.lines("drift.csv").size(), 1 + kRuns * kOutages);
  // Samples that are drawn, and what README says of a run and an outage, twice for temporaries.
  EXPECT_LT(grown, 70e6 + 2 * kRuns * (40 + 32 * kOutages));
}

TEST(Cross, EveryMethodOnEveryLog) {
  const std::vector<EvaluationCase> cases =
      cross({"x/a.rawlog", "x/b.rawlog", "y/b.rawlog"}, {"ekf", "rough"}, Settings());
  ASSERT_EQ(cases.size(), 6u);
  EXPECT_EQ(cases[0].recording, "a");
  EXPECT_EQ(cases[1].method, "rough");
  EXPECT_EQ(cases[2].recording, "x/b.rawlog");
  EXPECT_EQ(cases[4].recording, "y/b.rawlog");
}

TEST(Cross, NothingTwice) {
  EXPECT_THROW(cross({"a.rawlog", "a.rawlog"}, {"ekf"}, Settings()), UsageError);
  EXPECT_THROW(cross({"a.rawlog"}, {"ekf", "ekf"}, Settings()), UsageError);
}

TEST(WithPartsOff, EachAidAllOfThemCalibrationAndBoth) {
  Settings settings;
  settings.aids.gnss_velocity = "off";
  settings.aids.wheel_speed = "on";
  settings.aids.zero_velocity = "auto";
  settings.aids.nonholonomic = settings.aids.heading = "off";
  settings.calibrate.wheel_scale = "on";
  const Ablation ablation =
      with_parts_off(cross({"a.rawlog", "b.rawlog"}, {"ekf", "batch"}, settings));
  ASSERT_EQ(ablation.cases.size(), 2u * 2 * 6);
  ASSERT_EQ(ablation.names.size(), 2u * 6) << "logs share them";
  EXPECT_EQ(ablation.names[1].label(), "ekf without zero_velocity");
  EXPECT_EQ(ablation.cases[0].label, "");
  EXPECT_EQ(ablation.cases[1].label, ablation.names[1].label());
  EXPECT_THAT(ablation.cases[1].settings->aids.in_use(), ElementsAre("wheel_speed"));
  EXPECT_THAT(ablation.cases[3].settings->aids.in_use(), testing::IsEmpty());
  EXPECT_GT(ablation.cases[3].settings->calibrate.layout().slow_size(), 0);
  const Settings& calibration_off = *ablation.cases[4].settings;
  EXPECT_EQ(calibration_off.calibrate.layout().slow_size(), 0);
  EXPECT_EQ(calibration_off.aids.in_use().size(), 2u);
  EXPECT_EQ(ablation.names[5].without, "aids and calibration");

  settings.aids.mode = settings.calibrate.mode = "none";
  EXPECT_THROW(with_parts_off(cross({"a.rawlog"}, {"ekf"}, settings)), UsageError);
}

TEST(ExperimentRuns, OneAShift) {
  EvaluationCase c{"a.rawlog", "a", "ADIS16465", "ekf", "tuned ekf", std::make_shared<Settings>()};
  const std::vector<evaluation::ExperimentRun> runs = experiment_runs(c);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].method, "tuned ekf");
  EXPECT_EQ(runs[1].shift_s, 75);
  EXPECT_EQ(*runs[1].schedule.first_end_s(), 645);
  Settings without;
  without.outages.shifts_s.clear();
  c.settings = std::make_shared<Settings>(without);
  EXPECT_THROW(experiment_runs(c), UsageError);
  c = {"a.rawlog", "a", "ADIS16465", "kalman", "", std::make_shared<Settings>()};
  EXPECT_THROW(experiment_runs(c), UsageError);
}

TEST(ExperimentRuns, ErrorsOfTheEstimatorNameTheRecording) {
  const EvaluationCase c{"a.rawlog", "a", "ADIS16465", "ekf", "", std::make_shared<Settings>()};
  state::Sink sink;
  const std::unique_ptr<state::Estimator> estimator =
      experiment_runs(c)[0].make_estimator({}, sink);
  try {
    estimator->finish();  // without a single measurement
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("a: "));
  }
}

}  // namespace
}  // namespace foucault::app
