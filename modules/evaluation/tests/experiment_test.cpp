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
  std::string csv;
  for (const ExperimentResult& result : results) {
    csv += to_csv(drift_record_table(drift_records(result), default_drift_marks_s()));
  }
  return csv;
}

TEST(Experiment, ResultsDoNotDependOnTheNumberOfThreads) {
  const std::string one = records_csv(run_experiments(test::drifting_runs(), 1));
  EXPECT_EQ(records_csv(run_experiments(test::drifting_runs(), 2)), one);
  EXPECT_EQ(records_csv(run_experiments(test::drifting_runs(), 8)), one);
}

/// Fails as soon as it gets an increment.
class FailingEstimator : public state::Estimator {
 public:
  void process(const Measurement& measurement) override {
    if (std::holds_alternative<ImuIncrement>(measurement)) throw EstimatorFailure("lost its way");
  }
  void finish() override {}
};

TEST(Experiment, AMethodThatFailsTakesNoOtherWithIt) {
  std::vector<ExperimentRun> runs = test::drifting_runs();
  runs[1].make_estimator = [](const state::Mounting&, state::Sink&) {
    return std::make_unique<FailingEstimator>();
  };
  const std::vector<ExperimentResult> results = run_experiments(runs, 2);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].failure, i == 1 ? "lost its way" : "");
    EXPECT_EQ(results[i].run.drifts.empty(), i == 1);
  }
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
