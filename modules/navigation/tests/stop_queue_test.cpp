#include "../src/stop_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foucault::navigation {
namespace {

using ::testing::SizeIs;

constexpr int64_t kMs = 1'000'000;

GnssFix fix_at(int64_t ms) {
  GnssFix fix;
  fix.t_ns = ms * kMs;
  return fix;
}

int64_t ms(const std::optional<int64_t>& t_ns) { return t_ns ? *t_ns / kMs : -1; }

TEST(StopQueue, StopsAtEventsInOrderAndAtTheHold) {
  StopQueue stops(1.0);
  stops.start(0);
  stops.add(fix_at(700));
  stops.add(EpochRequest{300 * kMs});
  EXPECT_EQ(stops.next(0, 299 * kMs), std::nullopt);
  EXPECT_EQ(ms(stops.next(0, 2000 * kMs)), 300);
  EXPECT_EQ(stops.take_due(299 * kMs), std::nullopt);
  EXPECT_TRUE(std::holds_alternative<EpochRequest>(stops.take_due(300 * kMs).value()));
  EXPECT_EQ(ms(stops.next(300 * kMs, 2000 * kMs)), 700);
  EXPECT_EQ(stamp(stops.take_due(700 * kMs).value()), 700 * kMs);
  EXPECT_EQ(ms(stops.next(700 * kMs, 2000 * kMs)), 1000);
  EXPECT_FALSE(stops.hold_is_due(1000 * kMs - 1));
  EXPECT_TRUE(stops.hold_is_due(1000 * kMs));
}

TEST(StopQueue, AUsedFixAndAHoldPutTheNextHoldOff) {
  StopQueue stops(1.0);
  stops.start(0);
  stops.held(1000 * kMs);
  EXPECT_EQ(ms(stops.next(1000 * kMs, 9000 * kMs)), 2000);
  stops.fix_used(1500 * kMs);
  EXPECT_EQ(ms(stops.next(1500 * kMs, 9000 * kMs)), 2500);
  EXPECT_EQ(stops.last_fix_ns(), 1500 * kMs);
}

/// Used fixes 990 ms apart: the next is expected at 2980, 10 ms before the hold is due, which waits
/// the twentieth of its interval for it. One expected half a second off is not waited for.
TEST(StopQueue, TheHoldWaitsForAFixThatJitters) {
  StopQueue stops(1.0);
  stops.start(0);
  stops.fix_used(1000 * kMs);
  EXPECT_EQ(stops.fix_interval(), 0);
  stops.fix_used(1990 * kMs);
  EXPECT_NEAR(stops.fix_interval(), 0.99, 1e-12);
  EXPECT_EQ(ms(stops.next(1990 * kMs, 9000 * kMs)), 3040);
  stops.fix_used(2490 * kMs);
  EXPECT_EQ(ms(stops.next(2490 * kMs, 9000 * kMs)), 3490);
}

TEST(StopQueue, ClearGivesWhatIsPendingAndForgetsTheInterval) {
  StopQueue stops(1.0);
  stops.start(0);
  stops.fix_used(1000 * kMs);
  stops.fix_used(2000 * kMs);
  stops.add(fix_at(5000));
  stops.add(EpochRequest{4000 * kMs});
  EXPECT_THAT(stops.pending_fixes(), SizeIs(1));
  const std::vector<Measurement> pending = stops.clear();
  ASSERT_THAT(pending, SizeIs(2));
  EXPECT_EQ(stamp(pending[0]), 4000 * kMs);
  EXPECT_EQ(stamp(pending[1]), 5000 * kMs);
  EXPECT_THAT(stops.pending_fixes(), SizeIs(0));
  EXPECT_EQ(stops.last_fix_ns(), std::nullopt);
  EXPECT_EQ(stops.fix_interval(), 0);
}

}  // namespace
}  // namespace foucault::navigation
