#include "foucault/evaluation/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "foucault/core/error.h"
#include "support/drifting_experiment.h"

namespace foucault::evaluation {
namespace {

using testing::HasSubstr;

std::string records_csv(const std::vector<ExperimentResult>& results) {
  return to_csv(drift_record_table(drift_records(results), default_drift_marks_s()));
}

TEST(Experiment, ResultsDoNotDependOnTheNumberOfThreads) {
  const std::string one = records_csv(run_experiments(test::drifting_runs(), 1));
  EXPECT_EQ(records_csv(run_experiments(test::drifting_runs(), 2)), one);
  EXPECT_EQ(records_csv(run_experiments(test::drifting_runs(), 8)), one);
}

TEST(Experiment, TablesJoinRecordingsAndShifts) {
  const std::vector<ExperimentResult> results = run_experiments(test::drifting_runs(), 2);
  const std::vector<MethodOutages> rows = table_rows(results);
  // 100, 150, 200 and 125, 175, 225 in each recording
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].group, "b");
  EXPECT_EQ(rows[0].entries.size(), 6u);
  EXPECT_EQ(rows[4].group, "all recordings");
  EXPECT_EQ(rows[4].entries.size(), 12u);
  EXPECT_EQ(to_csv(drift_rms_table(method_drifts(rows), "Recording")),
            "Recording,good Hor,good Ver,bad Hor,bad Ver\n"
            "b,9.00,3.00,18.00,3.00\n"
            "a,9.00,3.00,18.00,3.00\n"
            "all recordings,9.00,3.00,18.00,3.00\n");
}

TEST(Experiment, ImusAreRowsIfThereAreSeveral) {
  std::vector<ExperimentRun> runs = test::drifting_runs();
  for (ExperimentRun& run : runs) run.imu = run.recording == "a" ? "IMU A" : "IMU B";
  const std::vector<ExperimentResult> results = run_experiments(runs, 2);
  const std::vector<MethodOutages> rows = table_rows(results);
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].group, "IMU B");
  EXPECT_EQ(rows[2].group, "IMU A");
}

/// What one method misses is left out for the other, too, and counted.
TEST(Experiment, OnlyCommonOutagesAreCompared) {
  std::vector<ExperimentResult> results = run_experiments(test::drifting_runs(), 2);
  results[1].run.drifts.erase(results[1].run.drifts.begin() + 1);
  const std::vector<MethodOutages> outages = group_outages(results, Grouping::all);
  ASSERT_EQ(outages.size(), 2u);
  for (const MethodOutages& o : outages) EXPECT_EQ(o.entries.size(), 11u);
  EXPECT_EQ(outages[0].missing, 0);
  EXPECT_EQ(outages[1].missing, 1);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(outages[0].entries[i].run->recording, outages[1].entries[i].run->recording);
    EXPECT_EQ(outages[0].entries[i].drift->outage.begin_ns,
              outages[1].entries[i].drift->outage.begin_ns);
  }
}

/// Fails as soon as it gets an increment.
class FailingEstimator : public state::Estimator {
 public:
  void process(const Measurement& measurement) override {
    if (std::holds_alternative<ImuIncrement>(measurement)) throw EstimatorFailure("lost its way");
  }
  void finish() override {}
};

/// It is left out in every recording and shift, and the others stay.
TEST(Experiment, AMethodThatFailsOnceTakesNoOtherWithIt) {
  const std::string others = [] {
    std::vector<ExperimentRun> runs = test::drifting_runs();
    const auto is_bad = [](const ExperimentRun& run) { return run.method == "bad"; };
    runs.erase(std::remove_if(runs.begin(), runs.end(), is_bad), runs.end());
    return records_csv(run_experiments(runs, 2));
  }();
  std::vector<ExperimentRun> runs = test::drifting_runs();
  runs[1].make_estimator = [](const state::Mounting&, state::Sink&) {
    return std::make_unique<FailingEstimator>();
  };
  std::vector<ExperimentResult> results = run_experiments(runs, 2);
  EXPECT_THAT(take_out_failed(results), testing::ElementsAre("method bad: lost its way"));
  EXPECT_EQ(results.size(), 4u);
  EXPECT_EQ(records_csv(results), others);
}

TEST(Experiment, AShortRecordingIsToldWhatToChange) {
  try {
    run_experiments({test::drifting_run("short", "good", 1, 25, 120),
                     test::drifting_run("short", "good", 1, 0, 120)},
                    2);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("short: no outage fits into its 120 s of fixes"));
    EXPECT_THAT(error.what(), HasSubstr("end after 130 s"));
    EXPECT_THAT(error.what(), HasSubstr("outages.first_s"));
  }
}

TEST(Experiment, AShiftMayLackOutages) {
  const std::vector<ExperimentResult> results = run_experiments(
      {test::drifting_run("a", "good", 1, 25, 140), test::drifting_run("a", "good", 1, 0, 140)}, 1);
  EXPECT_TRUE(results[0].run.drifts.empty());
  EXPECT_EQ(results[1].run.drifts.size(), 1u);
}

TEST(Experiment, TrackKeepsErrorsAndProgressGoesOn) {
  double last = 0;
  const ExperimentResult result =
      run_experiment(test::drifting_run("a", "good", 1, 0), [&](double part) { last = part; });
  EXPECT_GE(last, 1);
  ASSERT_FALSE(result.track.empty());
  double largest = 0;
  for (const TrackPoint& point : result.track) largest = std::max(largest, point.horizontal());
  EXPECT_NEAR(largest, 0.01 * 30.25 * 30.25, 1e-4);  // the next fix comes after 30.5 s
}

TEST(ErrorTrack, StaysSmallAndKeepsPeaks) {
  ErrorTrack track(100);
  state::Epoch epoch;
  for (int i = 0; i < 100'000; ++i) {
    epoch.t_ns = i * 100'000'000LL;
    track.add(epoch, {i == 54'321 ? 7.0 : 1.0, 0, 0});
  }
  EXPECT_LE(track.points().size(), 100u);
  EXPECT_GT(track.points().size(), 40u);
  double largest = 0;
  int64_t before = -1;
  for (const TrackPoint& point : track.points()) {
    EXPECT_GT(point.t_ns, before);
    before = point.t_ns;
    largest = std::max(largest, point.horizontal());
  }
  EXPECT_EQ(largest, 7.0);
}

}  // namespace
}  // namespace foucault::evaluation
