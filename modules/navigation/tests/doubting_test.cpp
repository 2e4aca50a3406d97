#include "../src/doubting.h"

#include <gtest/gtest.h>

#include "fake_run.h"

namespace foucault::navigation {
namespace {

using testing::at;
using testing::fix_at;
using testing::increment_between;
using Vector3d = Eigen::Vector3d;

/// A navigator that stands still, settled, and a fix 100 m off at 12 s.
class DoubtingTest : public ::testing::Test {
 protected:
  DoubtingTest() {
    state::Epoch initial;
    initial.t_ns = at(12000);
    navigator_.start(initial);
    judge_.start(at(0));
    const GnssFix fix = fix_at(12000, Vector3d(100, 0, 0));
    doubting_.emplace(fix,
                      std::make_unique<diagnosis::FixDoubt>(options_, judge_, navigator_,
                                                            options_.weighted(fix), false),
                      options_);
  }

  diagnosis::GnssOptions options_;
  diagnosis::FixJudge judge_{options_};
  testing::Log log_;
  testing::FakeNavigator navigator_{log_, Vector3d::Zero()};
  std::optional<Doubting> doubting_;
};

TEST_F(DoubtingTest, AFixThatAgreesAgainEndsItAndTheOthersAreLeftOut) {
  EXPECT_FALSE(doubting_->take(increment_between(12000, 12500)));
  EXPECT_FALSE(doubting_->take(fix_at(13000)));
  EXPECT_TRUE(doubting_->take(increment_between(12500, 13500)));
  const diagnosis::DoubtOutcome outcome = doubting_->outcome();
  ASSERT_GE(outcome.fixes.size(), 1u);
  EXPECT_EQ(outcome.fixes[0].fix.t_ns, doubting_->doubted().t_ns);
  EXPECT_EQ(outcome.fixes[0].action, diagnosis::FixDecision::Action::leave_out);
  ASSERT_EQ(doubting_->held().size(), 3u);
  EXPECT_EQ(stamp(doubting_->held()[1]), at(13000));
}

TEST_F(DoubtingTest, FixesThatMayNotBeUsedAreHeldButNotShown) {
  GnssFix none = fix_at(13000);
  none.position_covariance.setZero();
  EXPECT_FALSE(doubting_->take(none));
  EXPECT_FALSE(doubting_->take(increment_between(12000, 13500)));
  EXPECT_EQ(doubting_->held().size(), 2u);
}

}  // namespace
}  // namespace foucault::navigation
