#include "foucault/evaluation/outage_join.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "foucault/evaluation/summary.h"
#include "support/drifting_experiment.h"

namespace foucault::evaluation {
namespace {

TEST(OutageJoin, TablesJoinRecordingsAndShifts) {
  const EvaluationSummary summary(run_experiments(test::drifting_runs(), 2));
  const std::vector<MethodOutages>& rows = summary.rows();
  // 100, 150, 200 and 125, 175, 225 in each recording
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].group, "b");
  EXPECT_EQ(rows[0].size(), 6u);
  EXPECT_EQ(rows[4].group, "all recordings");
  EXPECT_EQ(rows[4].size(), 12u);
  EXPECT_EQ(to_csv(summary.rms_table()),
            "Recording,good Hor,good Ver,bad Hor,bad Ver\n"
            "b,9.00,3.00,18.00,3.00\n"
            "a,9.00,3.00,18.00,3.00\n"
            "all recordings,9.00,3.00,18.00,3.00\n");
}

/// What one method misses is left out for the other, too, and counted.
TEST(OutageJoin, OnlyCommonOutagesAreCompared) {
  std::vector<ExperimentResult> results = run_experiments(test::drifting_runs(), 2);
  results[1].run.drifts.erase(results[1].run.drifts.begin() + 1);
  const std::vector<MethodOutages> outages = group_outages(results, Grouping::all);
  ASSERT_EQ(outages.size(), 2u);
  for (const MethodOutages& o : outages) EXPECT_EQ(o.size(), 11u);
  EXPECT_EQ(outages[0].missing, 0);
  EXPECT_EQ(outages[1].missing, 1);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(outages[0].drawn[i]->recording, outages[1].drawn[i]->recording);
    EXPECT_EQ(outages[0].drawn[i]->drift.outage.begin_ns,
              outages[1].drawn[i]->drift.outage.begin_ns);
  }
}

/// One that ran on one recording of two: the other one has no outage that all methods have.
TEST(OutageJoin, AMethodThatIsNotEverywhere) {
  std::vector<ExperimentResult> results = run_experiments(test::drifting_runs(), 2);
  const auto is_bad_on_a = [](const auto& r) { return r.recording == "a" && r.method == "bad"; };
  results.erase(std::remove_if(results.begin(), results.end(), is_bad_on_a), results.end());
  for (const MethodOutages& o : group_outages(results, Grouping::all)) EXPECT_EQ(o.size(), 6u);
  const std::vector<MethodOutages> recordings = group_outages(results, Grouping::recording);
  ASSERT_EQ(recordings.size(), 3u);
  EXPECT_EQ(recordings[2].group, "a");
  EXPECT_EQ(recordings[2].size(), 6u);
}

/// Runs of one outage with many samples: of all outages the maxima are there, of some the samples.
TEST(OutageJoin, DrawsAsManyAsThereIsRoomFor) {
  constexpr int kRuns = 3000;
  std::vector<RunName> names;
  for (int i = 0; i < kRuns; ++i) {
    for (const char* method : {"good", "bad"}) names.push_back({"a", "none", method, 1.0 * i});
  }
  OutageJoin join({names.size(), [&](std::size_t i) { return names[i]; }}, Grouping::all);
  for (std::size_t i = 0; i < names.size(); i += 2) {
    std::vector<ExperimentResult> results(2);
    for (std::size_t m = 0; m < 2; ++m) {
      static_cast<RunName&>(results[m]) = names[i + m];
      std::vector<DriftSample> samples(600, {1, {1.0 + static_cast<double>(i), 0, 0}});
      results[m].run.drifts.push_back(outage_drift({0, 0, 60'000'000'000}, samples, {}));
    }
    join.add({&results[0], &results[1]});
  }
  const std::vector<MethodOutages> outages = join.take();
  ASSERT_EQ(outages.size(), 2u);
  EXPECT_EQ(outages[0].size(), static_cast<std::size_t>(kRuns));
  const auto& drawn = outages[0].drawn;
  EXPECT_LE(drawn.size(), 416u) << "half a million samples in all";
  EXPECT_GE(drawn.size(), 150u);
  ASSERT_EQ(outages[1].drawn.size(), drawn.size());
  double mean_shift_s = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_EQ(outages[1].drawn[i]->shift_s, drawn[i]->shift_s);
    mean_shift_s += drawn[i]->shift_s / static_cast<double>(drawn.size());
  }
  EXPECT_NEAR(mean_shift_s, kRuns / 2, 0.1 * kRuns) << "evenly";  // 4 sigmas
}

}  // namespace
}  // namespace foucault::evaluation
