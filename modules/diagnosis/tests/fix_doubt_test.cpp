#include "foucault/diagnosis/fix_doubt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "straight_navigator.h"

namespace foucault::diagnosis {
namespace {

using Action = FixDecision::Action;
using Eigen::Vector3d;
using ::testing::IsEmpty;

/// Fixes that are in error as they like while the vehicle stands still, and what is made of them.
class FixDoubtTest : public ::testing::Test {
 protected:
  FixDoubtTest() : judge_(options_) {}

  void begin(const Vector3d& error_n, bool returns = false) {
    doubt_.emplace(options_, judge_, StraightNavigator(rest(0.05, 0.01)), fix_at(0, error_n),
                   returns);
  }
  bool drive(double begin_s, double end_s) {
    return doubt_->add(increment_between(begin_s, end_s));
  }
  std::vector<Action> actions() {
    std::vector<Action> actions;
    for (const FixDecision& decision : doubt_->outcome().fixes) actions.push_back(decision.action);
    return actions;
  }

  GnssOptions options_;
  FixJudge judge_;
  std::optional<FixDoubt> doubt_;
};

TEST_F(FixDoubtTest, AFixThatAgreesAgainEndsIt) {
  begin({10, 0, 0});
  EXPECT_FALSE(doubt_->add(fix_at(1, {0, 0, 0})));
  EXPECT_TRUE(drive(0, 1));
  EXPECT_THAT(actions(), ::testing::ElementsAre(Action::leave_out, Action::use));
}

/// Inside increments, at their ends, and more of them in one.
TEST_F(FixDoubtTest, FixesAreMetAtTheirStamps) {
  begin({10, 0, 0});
  for (const double t : {0.25, 0.5, 1.0}) EXPECT_FALSE(doubt_->add(fix_at(t, {10, 0, 0})));
  EXPECT_FALSE(drive(0, 1));
  EXPECT_FALSE(doubt_->add(fix_at(1, {10, 0, 0})));   // at the present stamp
  EXPECT_FALSE(doubt_->add(fix_at(0.5, {0, 0, 0})));  // late: no matter
  EXPECT_EQ(actions().size(), 5u);
}

TEST_F(FixDoubtTest, IncrementsOverlapAndLeaveSlipsThatAreNoHoles) {
  begin({10, 0, 0});
  EXPECT_FALSE(drive(-1, 0));
  EXPECT_FALSE(drive(-0.5, 0.5));
  EXPECT_FALSE(drive(0.6, 1));
  EXPECT_FALSE(doubt_->add(fix_at(1.5, {0, 0, 0})));
  EXPECT_TRUE(drive(1, 2));
}

TEST_F(FixDoubtTest, AHoleEndsTheSight) {
  begin({10, 0, 0});
  EXPECT_FALSE(drive(0, 1));
  EXPECT_TRUE(drive(1.5, 2));
  EXPECT_TRUE(drive(2, 3));  // nothing more is looked at
  EXPECT_THAT(actions(), ::testing::ElementsAre(Action::leave_out));
}

TEST_F(FixDoubtTest, NoMoreFixesEndIt) {
  begin({10, 0, 0});
  EXPECT_FALSE(drive(0, 15));
  EXPECT_FALSE(drive(15, 30));
  EXPECT_TRUE(drive(30, 31));
}

TEST_F(FixDoubtTest, NothingMayFollow) {
  begin({10, 0, 0});
  EXPECT_THAT(doubt_->outcome().fixes, ::testing::SizeIs(1));
  EXPECT_THAT(doubt_->outcome().notices, IsEmpty());
}

TEST_F(FixDoubtTest, AfterAnOutageAReturnIsTried) {
  begin({0.1, 0, 0}, true);
  for (int t = 1; t <= 6; ++t) {
    doubt_->add(fix_at(t, {0.1, 0, 0}));
    drive(t - 1, t);
  }
  EXPECT_THAT(actions(), ::testing::Each(Action::use));
}

}  // namespace
}  // namespace foucault::diagnosis
