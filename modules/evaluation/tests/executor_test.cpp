#include "foucault/evaluation/executor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <string>

#include "foucault/evaluation/experiment.h"
#include "support/drifting_experiment.h"
#include "support/test_folder.h"

namespace foucault::evaluation {
namespace {

using testing::HasSubstr;

/// Ten things.
class ExecutorTest : public testing::Test {
 protected:
  ExecutorTest() {
    for (int i = 0; i < 10; ++i) batch_.keys.push_back(store::key_of(std::to_string(i)));
    batch_.compute = [this](std::size_t i, const TaskProgress&) {
      ++calls_;
      if (i == fails_at_) throw DataError("no way");
      return store::Record{std::to_string(i), 0.5};
    };
  }

  Batch batch_;
  store::MemoryRecords records_;
  std::atomic<int> calls_{0};
  std::size_t fails_at_ = 99;
};

TEST_F(ExecutorTest, ComputesWhatIsMissing) {
  records_.put(batch_.keys[3], {"found", 1});
  Executor executor(records_, {2, std::nullopt, true});
  EXPECT_EQ(executor.missing(batch_), 9u);
  executor.complete(batch_);
  EXPECT_EQ(calls_, 9);
  EXPECT_EQ(executor.computed(), 9u);
  EXPECT_EQ(executor.missing(batch_), 0u);
  EXPECT_EQ(executor.get(batch_, 3).content, "found");
  EXPECT_EQ(executor.get(batch_, 4).content, "4");
  EXPECT_EQ(executor.get(batch_, 4).cpu_s, 0.5);
  EXPECT_EQ(calls_, 9);
}

TEST_F(ExecutorTest, AFailureKeepsWhatWasFinished) {
  fails_at_ = 5;
  Executor executor(records_, {1, std::nullopt, true});
  EXPECT_THROW(executor.complete(batch_), DataError);
  fails_at_ = 99;
  executor.complete(batch_);
  EXPECT_EQ(calls_, 6 + 5);
}

TEST_F(ExecutorTest, WithoutComputingItSaysHowManyAreMissing) {
  records_.put(batch_.keys[3], {"found", 1});
  Executor executor(records_, {2, std::nullopt, false});
  try {
    executor.complete(batch_);
    FAIL();
  } catch (const store::StoreError& error) {
    EXPECT_THAT(error.what(), HasSubstr("9 of 10 runs are missing"));
  }
  EXPECT_EQ(executor.get(batch_, 3).content, "found");
  EXPECT_THROW(executor.get(batch_, 4), store::StoreError);
  EXPECT_EQ(calls_, 0);
}

TEST_F(ExecutorTest, WhoHasAShareDoesTheRestInTheEnd) {
  Executor executor(records_, {1, store::Shard{1, 2}, true});
  executor.complete(batch_);
  EXPECT_EQ(executor.missing(batch_), 0u);
  EXPECT_EQ(executor.computed(), 10u);
}

TEST_F(ExecutorTest, ADamagedRecordIsComputedAgain) {
  const test::TestFolder folder;
  store::RecordStore store(folder / "store");
  Executor executor(store, {1, std::nullopt, true});
  executor.complete(batch_);
  const std::string name = store::hex(batch_.keys[2]);
  folder.write("store/" + name.substr(0, 2) + "/" + name.substr(2), "nonsense");
  EXPECT_EQ(executor.get(batch_, 2).content, "2");
  EXPECT_EQ(executor.computed(), 11u);
  EXPECT_THAT(store.remarks(), testing::ElementsAre(HasSubstr(name.substr(2))));
}

/// A run with all that a record can hold.
ExperimentRun odd_run() {
  ExperimentRun run = test::drifting_run("a", "good", 1, 0);
  auto remarks = std::make_shared<SourceRemarks>();
  remarks->damage = "broke off";
  remarks->notices = {{5, state::NoticeKind::skipped, "a notice, \"quoted\"\n"}};
  run.remarks = remarks;
  run.depends_on = "odd";
  return run;
}

void expect_same(const OutageDrift& a, const OutageDrift& b) {
  EXPECT_EQ(a.outage.begin_ns, b.outage.begin_ns);
  EXPECT_EQ(a.maximum.horizontal, b.maximum.horizontal);
  EXPECT_EQ(a.end.vertical, b.end.vertical);
  EXPECT_EQ(a.distance_m, b.distance_m);
  ASSERT_EQ(a.at_marks.size(), b.at_marks.size());
  for (std::size_t i = 0; i < a.at_marks.size(); ++i) {
    ASSERT_EQ(a.at_marks[i].has_value(), b.at_marks[i].has_value());
    if (a.at_marks[i]) EXPECT_EQ(a.at_marks[i]->horizontal, b.at_marks[i]->horizontal);
  }
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    EXPECT_EQ(a.samples[i].since_begin_s, b.samples[i].since_begin_s);
    EXPECT_EQ(a.samples[i].error_n, b.samples[i].error_n);
    EXPECT_EQ(a.samples[i].normalized.horizontal, b.samples[i].normalized.horizontal);
  }
  ASSERT_EQ(a.after_return.has_value(), b.after_return.has_value());
  if (!a.after_return) return;
  EXPECT_EQ(a.after_return->rms, b.after_return->rms);
  EXPECT_EQ(a.after_return->settled_s, b.after_return->settled_s);
}

TEST(ExperimentRecord, ComesBackWithoutLoss) {
  const ExperimentResult direct = run_experiment(odd_run(), {});
  const Experiment all = experiment({odd_run()});
  store::MemoryRecords records;
  Executor executor(records, {1, std::nullopt, true});
  executor.complete(all.batch);
  const ExperimentResult result = result_of(all, 0, executor);
  EXPECT_EQ(result.recording, "a");
  EXPECT_EQ(result.method, "good");
  EXPECT_EQ(result.run.truth, direct.run.truth);
  EXPECT_EQ(result.run.scheduled, direct.run.scheduled);
  EXPECT_EQ(result.run.first_fix_ns, direct.run.first_fix_ns);
  EXPECT_EQ(result.run.last_fix_ns, direct.run.last_fix_ns);
  EXPECT_EQ(result.run.withheld.size(), direct.run.withheld.size());
  EXPECT_GT(result.run.cpu_s, 0);
  ASSERT_EQ(result.run.drifts.size(), direct.run.drifts.size());
  ASSERT_FALSE(direct.run.drifts.empty());
  for (std::size_t i = 0; i < result.run.drifts.size(); ++i) {
    expect_same(result.run.drifts[i], direct.run.drifts[i]);
  }
  ASSERT_EQ(result.track.size(), direct.track.size());
  ASSERT_FALSE(direct.track.empty());
  for (std::size_t i = 0; i < result.track.size(); ++i) {
    EXPECT_EQ(result.track[i].t_ns, direct.track[i].t_ns);
    EXPECT_EQ(result.track[i].position.longitude, direct.track[i].position.longitude);
    EXPECT_EQ(result.track[i].error_n, direct.track[i].error_n);
  }
  EXPECT_EQ(result.remarks.damage, "broke off");
  ASSERT_EQ(result.remarks.notices.size(), 1u);
  EXPECT_EQ(result.remarks.notices[0].t_ns, 5);
  EXPECT_EQ(result.remarks.notices[0].kind, state::NoticeKind::skipped);
  EXPECT_EQ(result.remarks.notices[0].text, "a notice, \"quoted\"\n");
}

/// The recording may have another name among other recordings; the failure names it as it is now.
TEST(ExperimentRecord, FailuresNameTheRecordingAsItIsCalledNow) {
  ExperimentRun run = odd_run();
  run.make_estimator = [](const state::Mounting&,
                          state::Sink&) -> std::unique_ptr<state::Estimator> {
    throw EstimatorFailure("a: lost its way");
  };
  store::MemoryRecords records;
  Executor executor(records, {1, std::nullopt, true});
  executor.complete(experiment({run}).batch);
  run.recording = "x/a";
  EXPECT_EQ(result_of(experiment({run}), 0, executor).failure, "x/a: lost its way");
  EXPECT_EQ(executor.computed(), 1u);
}

TEST(ExperimentRecord, TracksOnlyWhereTheyAreWanted) {
  ExperimentRun run = odd_run();
  run.with_track = false;
  EXPECT_TRUE(run_experiment(run, {}).track.empty());
}

}  // namespace
}  // namespace foucault::evaluation
