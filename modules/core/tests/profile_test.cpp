#include "foucault/core/profile.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

namespace foucault {
namespace {

using std::chrono::milliseconds;

double seconds_of(const std::vector<StageTime>& times, Stage stage) {
  for (const StageTime& time : times) {
    if (time.stage == stage) return time.seconds;
  }
  return -1;
}

double sum(const std::vector<StageTime>& times) {
  return std::accumulate(times.begin(), times.end(), 0.0,
                         [](double s, const StageTime& time) { return s + time.seconds; });
}

/// Keeps the CPU busy for so long.
void work(double seconds) {
  const double end = process_cpu_s() + seconds;
  while (process_cpu_s() < end) {
  }
}

TEST(Profile, TimeCountsForTheInnermostTimer) {
  Profile profile;
  {
    const StageTimer outer(Stage::preintegrate);
    work(0.02);
    {
      const StageTimer inner(Stage::solve);
      work(0.06);
    }
    work(0.02);
  }
  const std::vector<StageTime> times = profile.times();
  // Within a window of 10 ms a busy machine may stop us in the one stage or the other. Counted
  // twice, the outer stage would have more than the inner.
  EXPECT_NEAR(seconds_of(times, Stage::solve), 0.06, 0.02);
  EXPECT_NEAR(seconds_of(times, Stage::preintegrate), 0.04, 0.02);
}

TEST(Profile, TellsOfOptimizationsToWhoAsks) {
  { const SolveTimer nobody(1, 2); }
  Profile profile;
  { const SolveTimer not_yet(1, 2); }
  std::vector<Solve> told;
  profile.tell_solves([&](const Solve& solve) { told.push_back(solve); });
  {
    SolveTimer timer(7, 20);
    timer.iterated();
    timer.iterated(3);
    work(0.01);
  }
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].t_ns, 7);
  EXPECT_EQ(told[0].nodes, 20u);
  EXPECT_EQ(told[0].iterations, 4);
  EXPECT_GE(told[0].seconds, 0.0099);
}

TEST(Profile, StagesAddUpToTheCpuTime) {
  const double before = process_cpu_s();
  Profile profile;
  for (int i = 0; i < 1000; ++i) {
    const StageTimer read(Stage::read);
    const StageTimer write(Stage::write);
    work(20e-6);
  }
  const std::vector<StageTime> times = profile.times();
  const double cpu = process_cpu_s() - before;
  // All but what the profile's making and our own two readings take.
  EXPECT_LE(sum(times), cpu);
  EXPECT_GT(sum(times), 0.95 * cpu);
}

TEST(Profile, SleepTakesNoTime) {
  Profile profile;
  {
    const StageTimer timer(Stage::read);
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_LT(seconds_of(profile.times(), Stage::read), 0.02);  // what a busy kernel charges
}

TEST(Profile, ListsWhatWasEntered) {
  Profile profile;
  profile.add(Stage::start, 0.25);
  for (int i = 0; i < 3; ++i) const StageTimer timer(Stage::align);
  const std::vector<StageTime> times = profile.times();
  ASSERT_EQ(times.size(), 3u);
  EXPECT_EQ(times[0].stage, Stage::start);
  EXPECT_DOUBLE_EQ(times[0].seconds, 0.25);
  EXPECT_EQ(times[1].stage, Stage::align);
  EXPECT_EQ(times[1].entries, 3);
  EXPECT_EQ(times[2].stage, Stage::other);
}

TEST(Profile, BelongsToItsThread) {
  Profile profile;
  std::thread([] {
    EXPECT_EQ(Profile::of_thread(), nullptr);
    const StageTimer timer(Stage::solve);
  }).join();
  EXPECT_EQ(seconds_of(profile.times(), Stage::solve), -1);
  EXPECT_THROW(Profile(), std::logic_error);
}

TEST(Profile, EndsWithItsLife) {
  { const Profile profile; }
  EXPECT_EQ(Profile::of_thread(), nullptr);
  const StageTimer timer(Stage::solve);  // reports to nobody
}

TEST(Profile, EveryStageHasAName) {
  for (std::size_t i = 0; i < kStages; ++i) {
    EXPECT_FALSE(std::string(stage_name(static_cast<Stage>(i))).empty());
  }
  EXPECT_STREQ(stage_name(Stage::draw), "draw");
  EXPECT_STREQ(stage_name(Stage::other), "other");
}

}  // namespace
}  // namespace foucault
