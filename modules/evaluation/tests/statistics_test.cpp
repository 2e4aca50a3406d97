#include "foucault/evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace foucault::evaluation {
namespace {

TEST(Statistics, ByHand) {
  const std::vector<double> values{4, 1, 3, 2};
  EXPECT_EQ(mean(values), 2.5);
  EXPECT_NEAR(root_mean_square(values), std::sqrt(7.5), 1e-15);
  EXPECT_EQ(quantile(values, 0), 1);
  EXPECT_EQ(quantile(values, 0.5), 2.5);
  EXPECT_NEAR(quantile(values, 0.95), 3.85, 1e-14);
  EXPECT_EQ(quantile(values, 1), 4);
  EXPECT_EQ(quantile({7}, 0.3), 7);
}

TEST(Statistics, InfiniteValuesMakeNoNan) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(quantile({1, 2, inf}, 0.5), 2);
  EXPECT_EQ(quantile({1, inf, inf}, 0.75), inf);
}

TEST(Summary, HasTheValuesAndOrderedIntervals) {
  const std::vector<double> values{5, 3, 8, 1, 9, 2, 7};
  const Summary s = summarize(values);
  EXPECT_EQ(s.count, 7);
  EXPECT_EQ(s.rms.value, root_mean_square(values));
  EXPECT_EQ(s.mean.value, 5);
  EXPECT_EQ(s.median.value, 5);
  EXPECT_EQ(s.max.value, 9);
  for (const Estimate& e : {s.rms, s.mean, s.median, s.p68, s.p95, s.max}) {
    EXPECT_LE(e.low, e.value);
    EXPECT_GE(e.high, e.value);
    EXPECT_GE(e.low, 1);
    EXPECT_LE(e.high, 9);
  }
}

TEST(Summary, IsTheSameEveryTime) {
  const std::vector<double> values{5, 3, 8, 1, 9, 2, 7};
  EXPECT_EQ(summarize(values).rms.low, summarize(values).rms.low);
  BootstrapOptions other;
  other.seed = 43;
  EXPECT_NE(summarize(values).rms.low, summarize(values, other).rms.low);
}

/// Of many values the intervals are those that the bootstrap tends to.
void expect_close(const Estimate& limit, const Estimate& bootstrap) {
  const double width = bootstrap.high - bootstrap.low;
  EXPECT_DOUBLE_EQ(limit.value, bootstrap.value);
  EXPECT_NEAR(limit.low, bootstrap.low, 0.1 * width);
  EXPECT_NEAR(limit.high, bootstrap.high, 0.1 * width);
}

struct Pairs {
  std::vector<double> base, other;
};

/// Drifts of two methods that have most of them in common.
Pairs pairs(int count) {
  std::mt19937 rng{42};
  std::exponential_distribution<double> drift(0.5);
  Pairs pairs;
  for (int i = 0; i < count; ++i) {
    const double common = drift(rng);
    pairs.base.push_back(common + 0.3 * drift(rng));
    pairs.other.push_back(common + 0.31 * drift(rng));
  }
  return pairs;
}

TEST(Summary, OfManyValuesIsTheLimit) {
  const std::vector<double> values = pairs(4000).base;
  BootstrapOptions resampling;
  resampling.most = values.size();
  const Summary limit = summarize(values), bootstrap = summarize(values, resampling);
  EXPECT_EQ(limit.count, 4000);
  for (const auto member :
       {&Summary::rms, &Summary::mean, &Summary::median, &Summary::p68, &Summary::p95}) {
    expect_close(limit.*member, bootstrap.*member);
  }
  EXPECT_EQ(limit.max.value, bootstrap.max.value);
  EXPECT_EQ(limit.max.high, bootstrap.max.high);
  EXPECT_EQ(limit.max.low, bootstrap.max.low);
}

TEST(Summary, OfManyValuesWithAnInfiniteOne) {
  std::vector<double> values = pairs(4000).base;
  values[7] = std::numeric_limits<double>::infinity();
  const Summary s = summarize(values);
  EXPECT_EQ(s.rms.low, values[7]);
  EXPECT_EQ(s.max.high, values[7]);
  EXPECT_TRUE(std::isfinite(s.p95.high));
}

TEST(PairedComparison, OfManyValuesIsTheLimit) {
  const auto [base, other] = pairs(4000);
  BootstrapOptions resampling;
  resampling.most = base.size();
  const PairedComparison limit = compare_paired(base, other);
  const PairedComparison bootstrap = compare_paired(base, other, resampling);
  expect_close(limit.rms_difference, bootstrap.rms_difference);
  expect_close(limit.relative, bootstrap.relative);
  EXPECT_EQ(limit.share_larger, bootstrap.share_larger);
  EXPECT_GT(bootstrap.p_value, 0.01) << "else there is nothing to compare";
  EXPECT_NEAR(limit.p_value, bootstrap.p_value, 0.03);  // 2.7 sigmas of 2000 draws at most
  EXPECT_EQ(compare_paired(base, base).p_value, 1);
}

TEST(Summary, OfNothingThrows) { EXPECT_THROW(summarize({}), std::invalid_argument); }

TEST(Summary, IntervalOfTheMeanCoversIt) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal(3, 1);
  BootstrapOptions options;
  options.resamples = 400;
  int covered = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> values(40);
    for (double& v : values) v = normal(rng);
    const Estimate e = summarize(values, options).mean;
    covered += e.low <= 3 && 3 <= e.high;
  }
  // 0.95 less the percentile bootstrap's own shortfall at n = 40 (2 %); 3 sigma of 400 trials is
  // 3 %.
  EXPECT_GT(covered, 0.90 * kTrials);
  EXPECT_LT(covered, 0.985 * kTrials);
}

TEST(PairedComparison, ByHand) {
  const PairedComparison c = compare_paired({3, 4}, {6, 8});
  EXPECT_EQ(c.count, 2);
  EXPECT_NEAR(c.rms_difference.value, std::sqrt(12.5), 1e-14);
  EXPECT_NEAR(c.relative.value, 1, 1e-14);
  EXPECT_NEAR(c.relative.low, 1, 1e-14);  // every outage is twice as large: nothing to vary
  EXPECT_NEAR(c.relative.high, 1, 1e-14);
  EXPECT_EQ(c.share_larger, 1);
  EXPECT_EQ(compare_paired({1, 2, 3}, {2, 2, 1}).share_larger, 0.5);
}

TEST(PairedComparison, SeesWhatSeparateIntervalsHide) {
  // Drifts differ a lot between outages, but the second method is always 5 % worse.
  std::vector<double> base;
  std::vector<double> other;
  for (int i = 0; i < 30; ++i) {
    base.push_back(1 + i);
    other.push_back(1.05 * (1 + i));
  }
  const PairedComparison c = compare_paired(base, other);
  EXPECT_GT(c.relative.low, 0.049);
  EXPECT_LT(c.relative.high, 0.051);
  EXPECT_LT(c.p_value, 0.01);
  EXPECT_GT(summarize(base).rms.high, summarize(other).rms.low);
}

TEST(PairedComparison, EqualMethodsAreNotDifferent) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  int significant = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> base(20);
    std::vector<double> other(20);
    for (std::size_t i = 0; i < 20; ++i) {
      base[i] = std::abs(5 + normal(rng));
      other[i] = std::abs(5 + normal(rng));
    }
    BootstrapOptions options;
    options.resamples = 200;
    significant += compare_paired(base, other, options).p_value < 0.05;
  }
  // 5 % of 200 are 10; 3 sigma of that count are 9.
  EXPECT_LT(significant, 20);
  EXPECT_EQ(compare_paired({1, 2, 3}, {1, 2, 3}).p_value, 1);
}

TEST(PairedComparison, NeedsPairs) {
  EXPECT_THROW(compare_paired({1}, {1, 2}), std::invalid_argument);
  EXPECT_THROW(compare_paired({}, {}), std::invalid_argument);
}

TEST(ChiSquare, KnownQuantiles) {
  // Tables (Abramowitz and Stegun 26.8).
  EXPECT_NEAR(chi_square_quantile(0.95, 1), 3.841458820694124, 1e-11);
  EXPECT_NEAR(chi_square_quantile(0.95, 3), 7.814727903251179, 1e-11);
  EXPECT_NEAR(chi_square_quantile(0.025, 3), 0.2157952826238982, 1e-12);
  EXPECT_NEAR(chi_square_quantile(0.975, 3), 9.348404, 5e-7);
  EXPECT_NEAR(chi_square_quantile(0.99, 5), 15.086272, 5e-7);
  EXPECT_NEAR(chi_square_quantile(0.025, 1), 0.000982069, 5e-10);
  EXPECT_NEAR(chi_square_quantile(0.025, 90), 65.646618, 5e-7);
  EXPECT_NEAR(chi_square_quantile(0.975, 90), 118.135893, 5e-7);
  EXPECT_NEAR(chi_square_quantile(0.5, 2), 2 * std::log(2), 1e-12);
  EXPECT_NEAR(chi_square_quantile(0.975, 100), 129.5611971858366, 1e-9);
  // 1500 degrees: near a Gaussian of variance 3000, Wilson and Hilferty to 1e-3.
  const double z = 1.959963984540054;
  const double h = 2.0 / (9 * 1500);
  EXPECT_NEAR(chi_square_quantile(0.975, 1500), 1500 * std::pow(1 - h + z * std::sqrt(h), 3), 1e-2);
}

TEST(ChiSquare, BandOfFiftyRuns) {
  const Band band = mean_nees_band(3, 50);
  EXPECT_NEAR(band.low, 117.98 / 50, 1e-3);
  EXPECT_NEAR(band.high, 185.80 / 50, 1e-3);
}

TEST(ChiSquare, BandOfAnEffectiveNumber) {
  // 2.5 samples of 3 components: 7.5 degrees, between the tables' 7 (1.690, 16.013) and 8 (2.180,
  // 17.535).
  const Band band = mean_nees_band(3, 2.5);
  EXPECT_GT(2.5 * band.low, 1.690);
  EXPECT_LT(2.5 * band.low, 2.180);
  EXPECT_GT(2.5 * band.high, 16.013);
  EXPECT_LT(2.5 * band.high, 17.535);
}

TEST(Autocorrelation, ByHand) {
  // Deviations -1.5, -0.5, 0.5, 1.5, squares 5.
  const std::vector<double> r = autocorrelation({1, 2, 3, 4}, 9);
  ASSERT_EQ(r.size(), 3U);
  EXPECT_NEAR(r[0], 1.25 / 5, 1e-15);
  EXPECT_NEAR(r[1], -1.5 / 5, 1e-15);
  EXPECT_NEAR(r[2], -2.25 / 5, 1e-15);
  EXPECT_EQ(autocorrelation({2, 2, 2}, 2), (std::vector<double>{0, 0}));
  EXPECT_TRUE(autocorrelation({}, 2).empty());
}

TEST(Autocorrelation, IntegratedByHand) {
  EXPECT_NEAR(integrated_autocorrelation({1, 2, 3, 4}), 1.5, 1e-14);  // lags 2, 3: negative
  EXPECT_EQ(integrated_autocorrelation({1, -1, 1, -1}), 1);           // less than independent
  EXPECT_EQ(integrated_autocorrelation({2, 2, 2}), 1);
  EXPECT_EQ(integrated_autocorrelation({}), 1);
}

}  // namespace
}  // namespace foucault::evaluation
