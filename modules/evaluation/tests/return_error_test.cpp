#include "foucault/evaluation/return_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kSecond = kNanosecondsPerSecond;
const Outage kOutage{2, 40 * kSecond, 100 * kSecond};

GnssFix fix_at(double t, double sigma = 0.1) {
  GnssFix fix;
  fix.t_ns = nanoseconds(t);
  fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  return fix;
}

/// Fixes every second from 101 s on, errors north every half.
ReturnCollector collected(const std::function<double(double since_return)>& north,
                          double sigma = 0.1, double until = 150) {
  ReturnCollector collector;
  for (double t = 101; t <= until; t += 0.5) {
    if (t == std::floor(t)) collector.fix(kOutage, fix_at(t, sigma));
    collector.error(nanoseconds(t), {north(t - 101), 0, 5});
  }
  return collector;
}

ReturnError result(const ReturnCollector& collector) { return collector.results().at(2); }

TEST(ReturnError, OfAnEstimateThatComesBackAtOnce) {
  const ReturnError error = result(collected([](double) { return 0.2; }));
  EXPECT_NEAR(error.rms, 0.2, 1e-12);  // heights do not count
  EXPECT_NEAR(error.maximum, 0.2, 1e-12);
  EXPECT_EQ(error.settled_s, 0);
}

TEST(ReturnError, OfAnEstimateThatRejectsFixesForAWhile) {
  const ReturnError error = result(collected([](double t) { return t < 12 ? 100.0 : 0.3 - 1e-9; }));
  EXPECT_EQ(error.maximum, 100);
  EXPECT_NEAR(error.rms, 100 * std::sqrt(24.0 / 61), 1e-3);  // 24 of 61 samples in 30 s
  EXPECT_EQ(error.settled_s, 12);
}

TEST(ReturnError, BackForGoodIsAfterTheLastTimeOutside) {
  EXPECT_EQ(result(collected([](double t) { return t == 20 ? 0.31 : 0.1; })).settled_s, 20.5);
}

TEST(ReturnError, WhatIsNotBackWithinTheReturnIsNever) {
  EXPECT_FALSE(result(collected([](double) { return 0.31; })).settled_s);
  EXPECT_FALSE(result(collected([](double t) { return t > 29 ? 1.0 : 0.0; })).settled_s);
  EXPECT_EQ(result(collected([](double t) { return t > 30 ? 1.0 : 0.0; })).settled_s, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ReturnError lost = result(collected([nan](double) { return nan; }));
  EXPECT_FALSE(lost.settled_s);
  EXPECT_TRUE(std::isinf(lost.rms));
}

TEST(ReturnError, TheSigmaIsThatOfTheLatestFixThatHasOne) {
  ReturnCollector collector;
  collector.fix(kOutage, fix_at(101, 0.1));
  collector.fix(kOutage, fix_at(102, 0));
  collector.fix(kOutage, fix_at(103, 1));
  collector.error(101 * kSecond, {0.2, 0, 0});
  collector.error(102 * kSecond, {0.4, 0, 0});
  EXPECT_FALSE(result(collector).settled_s);
  collector.error(103 * kSecond, {2.9, 0, 0});
  EXPECT_EQ(result(collector).settled_s, 2);
}

TEST(ReturnError, WithoutAnySigmaItNeverSettles) {
  EXPECT_FALSE(result(collected([](double) { return 0.0; }, 0)).settled_s);
}

TEST(ReturnError, ErrorsOfASmootherComeAfterAllFixes) {
  ReturnCollector collector;
  for (const int64_t begin : {101, 301}) {
    const Outage outage{begin / 100, 0, begin * kSecond};
    for (int64_t t = begin; t < begin + 100; ++t) {
      EXPECT_EQ(collector.fix(outage, fix_at(static_cast<double>(t))), t <= begin + 30);
    }
  }
  for (int64_t t = 50; t < 400; ++t) {
    collector.error(t * kSecond, {t < 200 ? 1.0 : 0.1, 0, 0});
  }
  const auto results = collector.results();
  ASSERT_EQ(results.size(), 2u);
  EXPECT_FALSE(results.at(1).settled_s);
  EXPECT_EQ(results.at(3).settled_s, 0);
  EXPECT_NEAR(results.at(3).maximum, 0.1, 1e-12);
}

TEST(ReturnError, WithoutFixesOrErrorsThereIsNone) {
  ReturnCollector collector;
  collector.error(101 * kSecond, {1, 0, 0});
  EXPECT_TRUE(collector.results().empty());
  collector.fix(kOutage, fix_at(102));
  EXPECT_TRUE(collector.results().empty());
}

}  // namespace
}  // namespace foucault::evaluation
