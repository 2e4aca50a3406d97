#include "foucault/calibration/recorded_way.h"

#include <gtest/gtest.h>

#include <limits>

namespace foucault::calibration {
namespace {

constexpr int64_t kMs = 1'000'000;

ImuIncrement increment(int64_t begin_ms, int64_t end_ms, double rate = 0.1) {
  ImuIncrement out;
  out.t_begin_ns = begin_ms * kMs;
  out.t_end_ns = end_ms * kMs;
  out.dtheta_b = {rate * out.dt(), 0, 0};
  out.dvel_b = {0, 0, -9.8 * out.dt()};
  return out;
}

state::Epoch epoch(int64_t ms) {
  state::Epoch out;
  out.t_ns = ms * kMs;
  return out;
}

GnssFix fix(int64_t ms) {
  GnssFix out;
  out.t_ns = ms * kMs;
  return out;
}

TEST(WayRecorder, SumsUpToTwentyMilliseconds) {
  WayRecorder recorder;
  recorder.epoch(epoch(0));
  for (int t = 0; t < 100; t += 5) recorder.add(increment(t, t + 5));
  const RecordedWay way = *recorder.way();
  ASSERT_EQ(way.increments.size(), 5u + 2u);  // of 15 ms: a fourth would be 20
  EXPECT_EQ(way.increments.front().t_begin_ns, 0);
  EXPECT_EQ(way.increments.back().t_end_ns, 100 * kMs);
  double angle = 0;
  for (const ImuIncrement& i : way.increments) angle += i.dtheta_b.x();
  EXPECT_NEAR(angle, 0.01, 1e-15);
}

TEST(WayRecorder, BridgesWhatIsMissingWithNoise) {
  WayRecorder recorder;
  recorder.epoch(epoch(0));
  recorder.add(increment(0, 20));
  recorder.add(increment(520, 540));
  const RecordedWay way = *recorder.way();
  ASSERT_EQ(way.increments.size(), 3u);
  EXPECT_NEAR(way.increments[1].dtheta_b.x(), 0.05, 1e-15);
  EXPECT_GT(way.increments[1].extra_gyro_noise_density, 0);
  EXPECT_GT(way.increments[1].extra_accel_noise_density, 0);
  EXPECT_EQ(way.increments[2].extra_accel_noise_density, 0);
}

TEST(WayRecorder, EndsAtALongHoleAndLeavesOutWhatIsDamaged) {
  WayRecorder recorder;
  recorder.epoch(epoch(0));
  recorder.add(increment(0, 20));
  ImuIncrement damaged = increment(20, 40);
  damaged.dvel_b.x() = std::numeric_limits<double>::quiet_NaN();
  recorder.add(damaged);
  recorder.add(increment(10, 30));  // backward
  recorder.add(increment(20, 40));
  recorder.add(increment(2000, 2020));
  recorder.add(increment(2020, 2040));
  const RecordedWay way = *recorder.way();
  ASSERT_EQ(way.increments.size(), 2u);
  EXPECT_EQ(way.increments.back().t_end_ns, 40 * kMs);
}

TEST(WayRecorder, StartsAMinuteAfterTheRunWithFixesThatWereUsed) {
  WayRecorder recorder;
  EXPECT_FALSE(recorder.way());
  for (int second = 0; second < 70; ++second) {
    recorder.add(fix(1000 * second));
    recorder.add(increment(1000 * second, 1000 * (second + 1)));
    recorder.epoch(epoch(1000 * second + 5500));
    if (second != 68) recorder.used(1000 * second * kMs);
  }
  const RecordedWay way = *recorder.way();
  EXPECT_EQ(way.start.t_ns, 65500 * kMs);
  EXPECT_EQ(way.increments.front().t_begin_ns, way.start.t_ns);
  ASSERT_EQ(way.fixes.size(), 3u);  // 66, 67, 69
  EXPECT_EQ(way.fixes[2].t_ns, 69000 * kMs);
  EXPECT_EQ(way.fixes[0].since_first_s, 66);
}

}  // namespace
}  // namespace foucault::calibration
