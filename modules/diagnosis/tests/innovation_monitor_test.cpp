#include "foucault/diagnosis/innovation_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "foucault/diagnosis/fix_doubt.h"
#include "straight_navigator.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;
using Eigen::Vector3d;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class InnovationMonitorTest : public ::testing::Test {
 protected:
  InnovationMonitorTest() : judge_(options_) {}

  /// One fix a second, in error by this, until it is decided or the fixes end, while the vehicle
  /// stands still where the state has it.
  DoubtOutcome outcome_of(const std::function<Vector3d(double)>& error_n, int seconds) {
    FixDoubt doubt(options_, judge_, StraightNavigator(rest(0.05, 0.01)), fix_at(0, error_n(0)),
                   false);
    for (int t = 1; t <= seconds; ++t) {
      doubt.add(fix_at(t, error_n(t)));
      if (doubt.add(increment_between(t - 1, t))) break;
    }
    return doubt.outcome();
  }

  static int count(const DoubtOutcome& outcome, Action action) {
    int count = 0;
    for (const FixDecision& decision : outcome.fixes) count += decision.action == action;
    return count;
  }

  static double off(const GnssFix& fix) {
    return geodesy::LocalFrame(kPlace).to_local(fix.antenna).norm();
  }

  GnssOptions options_;
  FixJudge judge_;
};

/// A step fault: used without the step, until it is over.
TEST_F(InnovationMonitorTest, AStepIsTakenOff) {
  const DoubtOutcome outcome =
      outcome_of([](double t) { return t < 20 ? Vector3d(10, 0, 0) : Vector3d::Zero(); }, 60);
  EXPECT_THAT(outcome.notices, ElementsAre(HasSubstr("are off by 10.00 m"),
                                           HasSubstr("agree with the IMU again; 20 since")));
  EXPECT_FALSE(outcome.state_was_wrong);
  EXPECT_FALSE(outcome.loosened);
  EXPECT_EQ(count(outcome, Action::leave_out), 6);  // until it was seen
  EXPECT_EQ(count(outcome, Action::use_corrected), 14);
  EXPECT_EQ(count(outcome, Action::use), 1);
  for (const FixDecision& decision : outcome.fixes) {
    if (decision.action != Action::use_corrected) continue;
    EXPECT_LT(off(decision.corrected), 0.01);
    EXPECT_GT(decision.corrected.position_covariance(0, 0), 0.01);  // the step's own errors
  }
}

TEST_F(InnovationMonitorTest, AStepThatStaysIsTheTruth) {
  for (const int seconds : {40, 200}) {  // no more fixes; until the doubt is given up
    const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(0, 10, 0); }, seconds);
    EXPECT_THAT(outcome.notices.back(), HasSubstr("off by 10.00 m since"));
    EXPECT_THAT(outcome.notices.back(), HasSubstr("have stayed so and are believed"));
    EXPECT_TRUE(outcome.state_was_wrong);
    ASSERT_TRUE(outcome.loosened);
    EXPECT_NEAR(state::part(outcome.loosened->diagonal(), state::block::position).x(), 100, 1);
    EXPECT_EQ(count(outcome, Action::use), std::min(seconds, 91) + 1);
  }
}

TEST_F(InnovationMonitorTest, AStepThatEndsTooSoonIsLeft) {
  const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(0, 10, 0); }, 20);
  EXPECT_FALSE(outcome.state_was_wrong);
  EXPECT_EQ(count(outcome, Action::use), 0);
}

/// A ramp fault: grows from nothing, faster than the IMU allows.
TEST_F(InnovationMonitorTest, ARampIsTakenOff) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) { return t < 30 ? Vector3d(1 + 0.5 * t, 0, 0) : Vector3d::Zero(); }, 60);
  EXPECT_THAT(outcome.notices,
              ElementsAre(HasSubstr("drift away by 0.50 m/s, which the IMU excludes"),
                          HasSubstr("agree with the IMU again")));
  EXPECT_EQ(count(outcome, Action::use_corrected), 24);
  EXPECT_FALSE(outcome.state_was_wrong);
}

TEST_F(InnovationMonitorTest, ARampThatGoesOnIsTheTruth) {
  const DoubtOutcome outcome =
      outcome_of([](double t) { return Vector3d(1 + 0.5 * t, 0, 0); }, 120);
  EXPECT_THAT(outcome.notices.back(), HasSubstr("contradict the IMU, the first by 1.00 m"));
  EXPECT_GT(count(outcome, Action::use), 80);
}

/// A jump and then a steady way: they come back from an error that the state has followed.
TEST_F(InnovationMonitorTest, AJumpThatDriftsBlamesTheState) {
  const DoubtOutcome outcome = outcome_of([](double t) { return Vector3d(50 + t, 0, 0); }, 60);
  EXPECT_THAT(outcome.notices, ElementsAre(HasSubstr("the first by 50.00 m; the state is taken")));
  ASSERT_TRUE(outcome.loosened);
  EXPECT_NEAR(state::part(outcome.loosened->diagonal(), state::block::velocity).x(), 1, 0.1);
  EXPECT_EQ(count(outcome, Action::use), static_cast<int>(outcome.fixes.size()));
}

TEST_F(InnovationMonitorTest, ABendBlamesTheState) {
  const DoubtOutcome outcome =
      outcome_of([](double t) { return Vector3d(2 + 0.5 * t * t, 0, 0); }, 60);
  EXPECT_THAT(outcome.notices, ElementsAre(HasSubstr("contradict the IMU")));
}

TEST_F(InnovationMonitorTest, ScatterMeansSigmasThatAreTooSmall) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) {
        const double sign = static_cast<int>(t) % 2 == 0 ? 1 : -1;
        return Vector3d(1.5 * sign, 0.05 * sign, 0.05 * sign);
      },
      60);
  ASSERT_EQ(outcome.level.size(), 6u);
  EXPECT_GT(outcome.level.front(), 50);
  EXPECT_EQ(count(outcome, Action::use), 6);
  EXPECT_THAT(outcome.notices, IsEmpty());
}

TEST_F(InnovationMonitorTest, WildScatterIsWaitedThrough) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) {
        const double sign = static_cast<int>(t) % 2 == 0 ? 1 : -1;
        return t < 30 ? Vector3d(60 * sign, 0, 0) : Vector3d::Zero();
      },
      60);
  EXPECT_EQ(count(outcome, Action::leave_out), 30);
  EXPECT_EQ(count(outcome, Action::use), 1);
}

/// Nothing else has come for too long: the state, unless outliers are likelier.
TEST_F(InnovationMonitorTest, WildScatterIsGivenUp) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) {
        const double sign = static_cast<int>(t) % 2 == 0 ? 1 : -1;
        return Vector3d(60 * sign, 0, 0);
      },
      120);
  EXPECT_THAT(outcome.notices, ElementsAre(HasSubstr("contradict the IMU")));
}

/// A step upon a step: the second line begins where the first one has ended.
TEST_F(InnovationMonitorTest, ALineThatIsMissedThreeTimesEnds) {
  const DoubtOutcome outcome = outcome_of(
      [](double t) {
        return t < 15 ? Vector3d(10, 0, 0) : t < 40 ? Vector3d(0, 12, 0) : Vector3d::Zero();
      },
      60);
  EXPECT_THAT(outcome.notices, ElementsAre(HasSubstr("off by 10.00 m"), HasSubstr("off by 12.00 m"),
                                           HasSubstr("agree with the IMU again")));
}

TEST_F(InnovationMonitorTest, AStateInDoubtYieldsToAFewFixes) {
  judge_.start(kBegin);
  const DoubtOutcome outcome = outcome_of([](double) { return Vector3d(10, 0, 0); }, 60);
  EXPECT_TRUE(outcome.state_was_wrong);
  EXPECT_EQ(count(outcome, Action::use), options_.reinstate_after + 1);
}

/// Faster than a look needs them, fixes are thinned.
TEST_F(InnovationMonitorTest, FastFixesAreThinned) {
  FixDoubt doubt(options_, judge_, StraightNavigator(rest(0.05, 0.01)), fix_at(0, {10, 0, 0}),
                 false);
  for (int t = 1; t <= 200; ++t) {
    doubt.add(fix_at(0.1 * t, t < 150 ? Vector3d(10, 0, 0) : Vector3d::Zero()));
    if (doubt.add(increment_between(0.1 * (t - 1), 0.1 * t))) break;
  }
  const DoubtOutcome outcome = doubt.outcome();
  EXPECT_THAT(outcome.notices, Contains(HasSubstr("off by 10.00 m")));
  EXPECT_EQ(count(outcome, Action::leave_out), 52);  // 5 s, to the next of every third
}

}  // namespace
}  // namespace foucault::diagnosis
