#include "foucault/diagnosis/fix_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "straight_navigator.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;

/// Of the fixes that come out, which are plausible; everything comes out in order.
class FixScreenTest : public ::testing::Test {
 protected:
  void add(double t, const Vector3d& error_n, double sigma = 0.1) {
    screen_.add(fix_at(t, error_n, sigma));
    take(false);
  }
  void take(bool all) {
    while (const std::optional<FixScreen::Screened> screened = screen_.next(all)) {
      if (std::holds_alternative<GnssFix>(screened->measurement)) {
        plausible_.push_back(screened->plausible);
      }
    }
  }
  FixScreen screen_;
  std::vector<bool> plausible_;
};

TEST_F(FixScreenTest, WhatItsNeighboursDoNotReachIsTold) {
  add(0, {0, 0, 0});
  EXPECT_THAT(plausible_, ElementsAre(true));  // the first passes
  add(1, {50, 0, 0});
  EXPECT_THAT(plausible_, ElementsAre(true));  // waits for the next
  add(2, {0, 0, 0});
  EXPECT_THAT(plausible_, ElementsAre(true, false));
  add(3, {0, 0, 0});
  take(true);
  EXPECT_THAT(plausible_, ElementsAre(true, false, true, true));
}

TEST_F(FixScreenTest, FiveThatAgreeAreBelievedBeforeAWrongFirstOne) {
  add(0, {60e3, 0, 0});
  for (int i = 1; i <= 6; ++i) add(i, {0, 0, 0});
  take(true);
  EXPECT_THAT(plausible_, ElementsAre(true, false, false, false, true, true, true));
}

TEST_F(FixScreenTest, OutliersDoNotAgree) {
  for (int i = 0; i < 10; ++i) add(i, {i % 2 == 0 ? 0.0 : 50.0 + 10 * i, 0, 0});
  take(true);
  for (int i = 1; i < 9; i += 2) EXPECT_FALSE(plausible_[static_cast<std::size_t>(i)]) << i;
}

/// 8 m/s^2 bend a way of two seconds by 4 m.
TEST_F(FixScreenTest, AnAccelerationExplainsABend) {
  for (const double bend : {3.9, 4.9 + 1.5}) {
    screen_ = FixScreen();
    plausible_.clear();
    add(0, {0, 0, 0});
    add(1, {bend, 0, 0});
    add(2, {0, 0, 0});
    EXPECT_THAT(plausible_, ElementsAre(true, bend < 5));
  }
}

TEST_F(FixScreenTest, OnlyTheHorizontalCountsAndBadSigmasPassUnseen) {
  add(0, {0, 0, 0});
  add(1, {0, 0, 500});
  add(2, {0, 0, 0});
  GnssFix bad = fix_at(2.5, {1e3, 0, 0});
  bad.position_covariance(0, 0) = std::nan("");
  screen_.add(bad);
  add(3, {0, 0, 0});
  take(true);
  EXPECT_THAT(plausible_, ElementsAre(true, true, true, true, true));
}

TEST_F(FixScreenTest, WaitsForThreeSecondsAtMost) {
  add(0, {0, 0, 0});
  add(1, {50, 0, 0});
  screen_.add(increment_between(3.5, 3.9));
  take(false);
  EXPECT_THAT(plausible_, ElementsAre(true));
  screen_.add(increment_between(3.9, 4.1));
  take(false);
  EXPECT_THAT(plausible_, ElementsAre(true, true));
}

TEST_F(FixScreenTest, GivesBackWhatWaitsAndStartsAnew) {
  add(0, {0, 0, 0});
  add(1, {50, 0, 0});
  EXPECT_EQ(screen_.take_all().size(), 1u);
  EXPECT_FALSE(screen_.next(true));
  screen_.restart();
  add(2, {1e3, 0, 0});
  EXPECT_THAT(plausible_, ElementsAre(true, true));  // none before it any more
}

}  // namespace
}  // namespace foucault::diagnosis
