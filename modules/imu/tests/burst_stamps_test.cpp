#include "foucault/imu/burst_stamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace foucault::imu {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kStart = 1'700'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;
constexpr int64_t kEnd = std::numeric_limits<int64_t>::max();

/// What comes out if a source looks two seconds ahead.
std::vector<int64_t> evened(const std::vector<int64_t>& stamps, BurstStamps& bursts) {
  std::deque<ImuSample> waiting;
  std::vector<int64_t> out;
  const auto take = [&](int64_t t_ns) {
    while (true) {
      const std::vector<int64_t>& taken = bursts.take(waiting, t_ns);
      if (taken.empty()) return;
      out.insert(out.end(), taken.begin(), taken.end());
      waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(taken.size()));
    }
  };
  for (const int64_t t_ns : stamps) {
    ImuSample sample;
    sample.t_ns = t_ns;
    waiting.push_back(sample);
    take(t_ns - 2000 * kMs);
  }
  take(kEnd);
  return out;
}

std::vector<int64_t> even_stamps(int samples, int64_t interval_ns) {
  std::vector<int64_t> stamps;
  for (int64_t i = 1; i <= samples; ++i) stamps.push_back(kStart + i * interval_ns);
  return stamps;
}

/// Those of even stamps, as a host gives them that gets `size` at a time.
std::vector<int64_t> in_bursts(const std::vector<int64_t>& even, std::size_t size,
                               int64_t within_ns) {
  std::vector<int64_t> stamps;
  for (std::size_t i = 0; i < even.size(); ++i) {
    const std::size_t last = std::min(i / size * size + size, even.size()) - 1;
    stamps.push_back(even[last] + static_cast<int64_t>(i % size) * within_ns);
  }
  return stamps;
}

struct Bursts {
  std::size_t size;
  int64_t interval_ns, within_ns;
};
class OfAllSizes : public ::testing::TestWithParam<Bursts> {};
INSTANTIATE_TEST_SUITE_P(Bursts, OfAllSizes,
                         ::testing::Values(Bursts{4, 5 * kMs, 20'000},    // issue: 20 us, 20 ms
                                           Bursts{4, 10 * kMs, 200'000},  // 0.2 ms, then 39 ms
                                           Bursts{2, 10 * kMs, 0},        // one stamp
                                           Bursts{32, 1 * kMs, 1'000},    // a FIFO
                                           Bursts{3, 20 * kMs, 500'000}));

TEST_P(OfAllSizes, AreMadeEven) {
  const Bursts b = GetParam();
  const std::vector<int64_t> truth = even_stamps(300 * static_cast<int>(b.size), b.interval_ns);
  BurstStamps bursts;
  const std::vector<int64_t> out = evened(in_bursts(truth, b.size, b.within_ns), bursts);
  ASSERT_EQ(out.size(), truth.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(out[i] - truth[i]), 0, 100) << i;  // [ns]
  }
  ASSERT_TRUE(bursts.summary().has_value());
  EXPECT_THAT(*bursts.summary(), HasSubstr("bursts of " + std::to_string(b.size)));
}

TEST(BurstStamps, EvenAndJitteringStampsStayToTheLastBit) {
  std::mt19937 rng{42};
  std::normal_distribution<double> jitter(0, 1e6);
  std::vector<int64_t> stamps = even_stamps(20000, 5 * kMs);
  for (int64_t& t_ns : stamps) {
    t_ns += static_cast<int64_t>(std::clamp(jitter(rng), -2e6, 2e6));  // as lab faults do
  }
  BurstStamps bursts;
  EXPECT_EQ(evened(stamps, bursts), stamps);
  EXPECT_FALSE(bursts.summary().has_value());
}

/// Nor are arrivals wholly at random bursts, nor holes, nor samples that are lost now and then.
TEST(BurstStamps, WhatOnlyLooksLikeBurstsStays) {
  std::mt19937 rng{42};
  std::exponential_distribution<double> interval(1 / 5e6);
  std::vector<int64_t> random{kStart};
  for (int i = 0; i < 20000; ++i) {
    random.push_back(random.back() + 1 + static_cast<int64_t>(interval(rng)));
  }
  std::vector<int64_t> holes, lost;
  const std::vector<int64_t> even = even_stamps(20000, 5 * kMs);
  for (std::size_t i = 0; i < even.size(); ++i) {
    const int64_t hole_ns = static_cast<int64_t>(i / 150) * 400 * kMs;  // 0.4 s after 0.75 s
    holes.push_back(even[i] + hole_ns);
    if (i % 10 < 6) lost.push_back(even[i]);
  }
  for (const std::vector<int64_t>& stamps : {random, holes, lost}) {
    BurstStamps bursts;
    EXPECT_EQ(evened(stamps, bursts), stamps);
  }
}

TEST(BurstStamps, AMissingBurstIsAHole) {
  const std::vector<int64_t> even = even_stamps(2000, 10 * kMs);
  std::vector<int64_t> truth, stamps = in_bursts(even, 4, 200'000);
  for (std::size_t i = 0; i < even.size(); ++i) {
    if (i < 1000 || i >= 1008) truth.push_back(even[i]);
  }
  stamps.erase(stamps.begin() + 1000, stamps.begin() + 1008);
  BurstStamps bursts;
  const std::vector<int64_t> out = evened(stamps, bursts);
  ASSERT_EQ(out.size(), truth.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(out[i] - truth[i]), 0, 100) << i;
  }
}

/// Bursts that begin in the middle of a recording, at another rate, and end again.
TEST(BurstStamps, FollowsARecordingThatChanges) {
  const std::vector<int64_t> truth = even_stamps(6000, 5 * kMs);
  std::vector<int64_t> stamps = in_bursts(truth, 4, 20'000);
  std::copy(truth.begin(), truth.begin() + 2000, stamps.begin());
  std::copy(truth.begin() + 4000, truth.end(), stamps.begin() + 4000);
  BurstStamps bursts;
  const std::vector<int64_t> out = evened(stamps, bursts);
  ASSERT_EQ(out.size(), truth.size());
  EXPECT_TRUE(std::is_sorted(out.begin(), out.end()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(out[i] - truth[i]), 0, 100) << i;
  }
}

}  // namespace
}  // namespace foucault::imu
