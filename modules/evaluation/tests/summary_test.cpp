#include "foucault/evaluation/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "foucault/core/error.h"
#include "support/drifting_experiment.h"

namespace foucault::evaluation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<ExperimentResult> results() { return run_experiments(test::drifting_runs(), 2); }

TEST(EvaluationSummary, JoinsByRecording) {
  const EvaluationSummary summary(results());
  EXPECT_THAT(summary.methods(), ElementsAre("good", "bad"));
  EXPECT_EQ(summary.row_header(), "Recording");
  ASSERT_EQ(summary.overall().size(), 2u);
  EXPECT_EQ(summary.overall()[0].size(), 12u);
  EXPECT_EQ(summary.rows().size(), 6u) << "two recordings and all, two methods";
  EXPECT_EQ(&summary.cases(), &summary.overall());
  EXPECT_TRUE(summary.distances().empty());
  EXPECT_EQ(summary.rms_table().rows.size(), 3u);
  EXPECT_EQ(summary.difference_table().header.size(), 4u);
  EXPECT_EQ(summary.statistics_table().rows.size(), 12u);
  EXPECT_FALSE(summary.normalized_table().rows.empty());
  EXPECT_FALSE(summary.return_table().rows.empty());
  EXPECT_EQ(outages_text(summary), "12 of 30 s in 2 recordings; truth: the reference");
}

TEST(EvaluationSummary, JoinsByImuIfThereAreSeveral) {
  std::vector<ExperimentResult> of_two = results();
  for (ExperimentResult& result : of_two) result.imu = result.recording;
  const EvaluationSummary summary(of_two);
  EXPECT_EQ(summary.row_header(), "IMU");
  EXPECT_EQ(&summary.cases(), &summary.rows());
}

TEST(EvaluationSummary, SaysWhatTheTablesRestOn) {
  const EvaluationSummary summary(results());
  const std::vector<std::string> lines = evaluation_lines(summary);
  EXPECT_THAT(lines.front(), HasSubstr("outages    12 of 30 s"));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("RMSEs")));
  EXPECT_THAT(lines.back(), HasSubstr("s CPU"));

  std::vector<ExperimentRun> runs{test::drifting_run("a", "good", 1, 0, 275, false),
                                  test::drifting_run("b", "good", 1, 0)};
  const EvaluationSummary mixed(run_experiments(runs, 1));
  EXPECT_THAT(outages_text(mixed), HasSubstr("else the withheld fixes"));
  runs.pop_back();
  const EvaluationSummary single(run_experiments(runs, 1));
  EXPECT_THAT(outages_text(single), HasSubstr("in 1 recording; truth: the withheld fixes"));
  EXPECT_LT(evaluation_lines(single).size(), lines.size()) << "no differences";
}

/// In whatever order they come, and one by one as all at once.
TEST(EvaluationSummary, DoesNotDependOnTheOrderOfMethods) {
  std::vector<ExperimentResult> by_method = results();
  std::stable_sort(by_method.begin(), by_method.end(), [](const auto& a, const auto& b) {
    return a.method == "good" && b.method != "good";
  });
  const EvaluationSummary one(results()), other(by_method);
  EXPECT_EQ(to_csv(one.statistics_table()), to_csv(other.statistics_table()));
  EXPECT_EQ(to_csv(one.normalized_table()), to_csv(other.normalized_table()));
  EXPECT_EQ(one.shown().size(), 4u) << "the first shift of both recordings";
  EXPECT_EQ(one.runs().size(), 8u);
}

/// A table of so many rows nobody reads: drift.csv has them all.
TEST(EvaluationSummary, VeryManyRecordingsAreOneRow) {
  std::vector<ExperimentResult> of_many;
  const ExperimentResult one = results().front();
  for (std::size_t i = 0; i <= EvaluationSummary::kMostRows; ++i) {
    of_many.push_back(one);
    of_many.back().recording = std::to_string(i);
  }
  const EvaluationSummary summary(of_many);
  ASSERT_EQ(summary.rows().size(), 1u);
  EXPECT_EQ(summary.rows()[0].group, "all recordings");
  EXPECT_EQ(summary.rows()[0].size(), 3 * of_many.size());
  EXPECT_EQ(summary.recordings(), of_many.size());
}

TEST(EvaluationSummary, MethodsWithoutACommonOutage) {
  const auto refusal = [](std::vector<ExperimentResult> of) -> std::string {
    try {
      const EvaluationSummary summary(of);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  std::vector<ExperimentResult> one = results();
  for (ExperimentResult& result : one) {
    if (result.method == "bad") result.run.drifts.clear();
  }
  EXPECT_THAT(refusal(one), HasSubstr("bad: gave nothing to measure in any outage"));
  std::vector<ExperimentResult> apart = results();
  for (ExperimentResult& result : apart) {
    if ((result.method == "bad") == (result.shift_s == 0)) result.run.drifts.clear();
  }
  EXPECT_THAT(refusal(apart), HasSubstr("no outage in common"));
}

}  // namespace
}  // namespace foucault::evaluation
