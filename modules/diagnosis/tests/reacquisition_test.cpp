#include "foucault/diagnosis/reacquisition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "foucault/diagnosis/fix_doubt.h"
#include "straight_navigator.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The state after an outage of a minute: errors of position have grown with those of velocity.
state::Epoch after_outage() {
  state::Epoch epoch = rest(3, 0.05);
  using namespace state::block;
  const Eigen::Matrix3d both = 0.99 * 3 * 0.05 * Eigen::Matrix3d::Identity();
  state::part(epoch.covariance, position, velocity) = both;
  state::part(epoch.covariance, velocity, position) = both;
  return epoch;
}

class ReacquisitionTest : public ::testing::Test {
 protected:
  ReacquisitionTest() : judge_(options_) {}

  DoubtOutcome outcome_of(const std::function<Vector3d(double)>& error_n, int seconds,
                          int interval = 1) {
    FixDoubt doubt(options_, judge_, StraightNavigator(after_outage()), fix_at(0, error_n(0)),
                   true);
    for (int t = interval; t <= seconds; t += interval) {
      doubt.add(fix_at(t, error_n(t)));
      if (doubt.add(increment_between(t - interval, t))) break;
    }
    return doubt.outcome();
  }

  static std::vector<Action> actions(const DoubtOutcome& outcome) {
    std::vector<Action> actions;
    for (const FixDecision& decision : outcome.fixes) actions.push_back(decision.action);
    return actions;
  }

  GnssOptions options_;
  FixJudge judge_;
};

/// 2 m and 2/60 m/s: as the covariance has it.
TEST_F(ReacquisitionTest, ADriftIsBelieved) {
  const DoubtOutcome outcome = outcome_of([](double t) { return Vector3d(2 + t / 30, 0, 0); }, 30);
  EXPECT_THAT(actions(outcome), ::testing::Each(Action::use));
  EXPECT_EQ(outcome.fixes.size(), 6u);
  EXPECT_FALSE(outcome.state_was_wrong);
  EXPECT_THAT(outcome.notices, IsEmpty());
}

/// 60 m and 1 m/s: the noise model was too small.
TEST_F(ReacquisitionTest, ALargeDriftDoubtsTheState) {
  const DoubtOutcome outcome = outcome_of([](double t) { return Vector3d(60 + t, 0, 0); }, 30);
  EXPECT_THAT(actions(outcome), ::testing::Each(Action::use));
  EXPECT_TRUE(outcome.state_was_wrong);
}

TEST_F(ReacquisitionTest, AnOutlierAmongTheFirstIsLeftOut) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) { return t == 2 ? Vector3d(0, 30, 0) : Vector3d(1 + t / 60, 0, 0); }, 30);
  EXPECT_THAT(actions(outcome), ElementsAre(Action::use, Action::use, Action::leave_out,
                                            Action::use, Action::use, Action::use));
}

/// 60 m, and no velocity to it: a wrong ambiguity. It jumps off it.
TEST_F(ReacquisitionTest, AnOffsetIsLeftOutUntilItJumps) {
  const DoubtOutcome outcome =
      outcome_of([](double t) { return t < 20 ? Vector3d(60, 0, 0) : Vector3d(0.5, 0, 0); }, 60);
  EXPECT_THAT(outcome.notices,
              ElementsAre(HasSubstr("are off by 60.00 m, but not their motion; left out"),
                          HasSubstr("those after it are believed")));
  const std::vector<Action> all = actions(outcome);
  ASSERT_EQ(all.size(), 23u);  // three that miss the offset
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i], i < 20 ? Action::leave_out : Action::use) << i;
  }
  EXPECT_FALSE(outcome.state_was_wrong);
}

TEST_F(ReacquisitionTest, AJumpFurtherAwayMakesThoseBeforeItTrue) {
  const DoubtOutcome outcome =
      outcome_of([](double t) { return t < 20 ? Vector3d(60, 0, 0) : Vector3d(200, 0, 0); }, 60);
  EXPECT_THAT(outcome.notices.back(), HasSubstr("those before it are believed"));
  EXPECT_EQ(actions(outcome).front(), Action::use);
  EXPECT_EQ(actions(outcome).back(), Action::leave_out);
  EXPECT_TRUE(outcome.state_was_wrong);
}

TEST_F(ReacquisitionTest, AnOffsetThatStaysIsTheTruth) {
  for (const int seconds : {40, 200}) {
    const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(60, 0, 0); }, seconds);
    EXPECT_THAT(outcome.notices.back(), HasSubstr("off by 60.00 m since"));
    EXPECT_THAT(actions(outcome), ::testing::Each(Action::use));
    EXPECT_TRUE(outcome.state_was_wrong);
    EXPECT_FALSE(outcome.loosened);
  }
}

TEST_F(ReacquisitionTest, TwoFixesDecideIfThereAreNoMore) {
  const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(1, 0, 0); }, 1);
  EXPECT_THAT(actions(outcome), ElementsAre(Action::use, Action::use));
}

/// A trial needs five fixes, and a doubt lasts for 90 s.
TEST_F(ReacquisitionTest, RareFixesAreBelieved) {
  const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(60, 0, 0); }, 300, 29);
  EXPECT_THAT(actions(outcome), ::testing::Each(Action::use));
  EXPECT_EQ(outcome.fixes.size(), 5u);
}

TEST_F(ReacquisitionTest, FastFixesAreThinned) {
  FixDoubt doubt(options_, judge_, StraightNavigator(after_outage()), fix_at(0, {1, 0, 0}), true);
  for (int t = 1; t <= 100; ++t) {
    doubt.add(fix_at(0.1 * t, {1, 0, 0}));
    if (doubt.add(increment_between(0.1 * (t - 1), 0.1 * t))) break;
  }
  EXPECT_EQ(doubt.outcome().fixes.size(), 52u);  // 5 s, to the next of every third
  EXPECT_THAT(actions(doubt.outcome()), ::testing::Each(Action::use));
}

}  // namespace
}  // namespace foucault::diagnosis
