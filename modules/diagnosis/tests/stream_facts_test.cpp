#include "foucault/diagnosis/stream_facts.h"

#include <gtest/gtest.h>

#include "foucault/core/hole.h"

namespace foucault::diagnosis {
namespace {

constexpr int64_t kStep = 10'000'000;

TEST(Hole, IsLongerThanOneAndAHalfIntervals) {
  EXPECT_FALSE(is_hole(1.49, 1.0));
  EXPECT_FALSE(is_hole(1.5, 1.0));
  EXPECT_TRUE(is_hole(1.51, 1.0));
  EXPECT_TRUE(is_hole(2 * kStep, kStep));
  EXPECT_FALSE(is_hole(1.0, 0.0));  // nothing usual is known yet
}

TEST(StreamWatch, CountsStampsAndHoles) {
  StreamWatch watch;
  EXPECT_EQ(watch.facts().count, 0);
  int64_t t = 5 * kStep;
  for (int k = 0; k < 3000; ++k) {
    watch.add(t);
    t += k == 700 ? 5 * kStep : k == 2000 ? 2 * kStep : kStep;
  }
  const StreamFacts& facts = watch.facts();
  EXPECT_EQ(facts.count, 3000);
  EXPECT_EQ(facts.first_ns, 5 * kStep);
  EXPECT_EQ(facts.last_ns, 5 * kStep + (2999 + 4 + 1) * kStep);
  EXPECT_DOUBLE_EQ(facts.interval_s, 0.01);
  EXPECT_EQ(facts.holes, 2);
  EXPECT_DOUBLE_EQ(facts.longest_hole_s, 0.05);
}

TEST(StreamWatch, StampsThatGoBackOrStayAreNoIntervals) {
  StreamWatch watch;
  for (const int64_t t : {0, 1, 1, 0, 2, 3}) watch.add(t * kStep);
  EXPECT_EQ(watch.facts().count, 6);
  EXPECT_EQ(watch.facts().holes, 0);
  EXPECT_DOUBLE_EQ(watch.facts().interval_s, 0.01);
}

}  // namespace
}  // namespace foucault::diagnosis
