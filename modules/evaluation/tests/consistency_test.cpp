#include "foucault/evaluation/consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"

namespace foucault::evaluation {
namespace {

Eigen::Matrix3d correlated_covariance() {
  Eigen::Matrix3d root;
  root << 0.02, 0, 0, 0.01, 0.015, 0, -0.005, 0.01, 0.05;
  return root * root.transpose();
}

/// Gaussian three-vectors that remember the one before: AR(1) with N(0, I).
class Noise {
 public:
  explicit Noise(double memory, unsigned seed = 42) : memory_(memory), rng_(seed) { next(); }

  Eigen::Vector3d next() {
    const Eigen::Vector3d white(normal_(rng_), normal_(rng_), normal_(rng_));
    state_ = started_ ? memory_ * state_ + std::sqrt(1 - memory_ * memory_) * white : white;
    started_ = true;
    return state_;
  }

 private:
  double memory_;
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

/// Fixes whose innovations have `sigma_error` times the sigmas that they are said to have.
Consistency of_fixes(int count, double memory, double sigma_error, unsigned seed = 42) {
  const Eigen::Matrix3d covariance = correlated_covariance();
  const Eigen::Matrix3d root = covariance.llt().matrixL();
  Noise noise(memory, seed);
  ConsistencyCollector collector;
  for (int i = 0; i < count; ++i) {
    state::FixResult fix;
    fix.t_ns = nanoseconds(0.5 * i);
    fix.innovation_n = sigma_error * root * noise.next();
    fix.innovation_covariance = covariance;
    collector.fix(fix);
  }
  return collector.result();
}

TEST(Whitened, ItsSquareIsTheNormalizedSquare) {
  const Eigen::Matrix3d P = correlated_covariance();
  const Eigen::Vector3d error(0.03, -0.01, 0.08);
  const double square = error.dot(P.llt().solve(error));
  EXPECT_NEAR(whitened(error, P)->squaredNorm(), square, 1e-12 * square);
}

TEST(Whitened, OfIndependentAxesIsErrorOverSigma) {
  const Eigen::Vector3d sigma(0.01, 20, 3e-5);
  const Eigen::Vector3d error(0.02, -10, 9e-5);
  const Eigen::Vector3d z = *whitened(error, sigma.cwiseAbs2().asDiagonal());
  EXPECT_TRUE(z.isApprox(Eigen::Vector3d(2, -0.5, 3), 1e-12)) << z.transpose();
}

TEST(Whitened, DoesNotDependOnTheOrderOfTheAxes) {
  const Eigen::Matrix3d P = correlated_covariance();
  const Eigen::Vector3d error(0.03, -0.01, 0.08);
  Eigen::Matrix3d swap;
  swap << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const Eigen::Vector3d z = *whitened(error, P);
  const Eigen::Vector3d z_swapped = *whitened(swap * error, swap * P * swap.transpose());
  EXPECT_TRUE(z_swapped.isApprox(swap * z, 1e-12));
}

TEST(Whitened, NoneWithoutAValidCovariance) {
  const Eigen::Vector3d error(1, 2, 3);
  EXPECT_FALSE(whitened(error, Eigen::Matrix3d::Zero()));
  EXPECT_FALSE(whitened(error, -Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(whitened(error, Eigen::Matrix3d::Ones()));  // the same number three times
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(whitened({nan, 0, 0}, Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(whitened(error, nan * Eigen::Matrix3d::Identity()));
}

TEST(CorrelatedMean, WhiteNumbersAreAllEffective) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal(3, 2);
  CorrelatedMean mean;
  for (int i = 0; i < 3000; ++i) mean.add(normal(rng));
  EXPECT_NEAR(mean.mean(), 3, 4 * 2 / std::sqrt(3000.0));
  // Autocorrelations of sigma 1 / sqrt(n) = 0.018 are summed until a pair of them is negative.
  EXPECT_GT(mean.effective_samples(), 0.85 * 3000);
  EXPECT_LE(mean.effective_samples(), 3000);
}

/// AR(1) with memory a: 1 + 2 sum a^k = (1 + a) / (1 - a).
TEST(CorrelatedMean, AutoregressiveNumbersAsTheoryHasIt) {
  for (const int count : {4000, 400'000}) {  // as they come, and joined to blocks of 128
    const double a = 0.9;
    Noise noise(a);
    CorrelatedMean mean;
    for (int i = 0; i < count; ++i) mean.add(noise.next().x());
    const double theory = count * (1 - a) / (1 + a);
    // The window takes some 60 lags: sigma sqrt(2 * 2 * 60 / n) of the sum (Sokal 1997), 25 % of
    // 4000; 400 000 are joined to at least 2048 blocks, nearly white, whose sum is good to 10 %.
    EXPECT_NEAR(mean.effective_samples(), theory, (count == 4000 ? 0.5 : 0.25) * theory);
  }
}

TEST(CorrelatedMean, OfNothingAndOfConstants) {
  EXPECT_EQ(CorrelatedMean().effective_samples(), 0);
  CorrelatedMean mean;
  for (int i = 0; i < 10; ++i) mean.add(2);
  EXPECT_EQ(mean.mean(), 2);
  EXPECT_EQ(mean.effective_samples(), 10);
}

TEST(StreamingAutocorrelation, IsThatOfTheWholeSeries) {
  Noise noise(0.7);
  StreamingAutocorrelation streaming(20);
  std::vector<double> east;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d value = noise.next() + Eigen::Vector3d(0, 5, 0);
    streaming.add(value);
    east.push_back(value.y());
  }
  const std::vector<double> expected = autocorrelation(east, 20);
  const std::vector<Eigen::Vector3d> lags = streaming.lags();
  ASSERT_EQ(lags.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_NEAR(lags[k].y(), expected[k], 1e-12);
}

TEST(StreamingAutocorrelation, ShortSeriesGiveFewLags) {
  StreamingAutocorrelation streaming(20);
  EXPECT_TRUE(streaming.lags().empty());
  for (int i = 0; i < 11; ++i) streaming.add({1.0 * i, 0, -1.0 * i});
  EXPECT_EQ(streaming.lags().size(), 2U);
  EXPECT_EQ(streaming.lags()[0].y(), 0);  // all equal
}

TEST(StretchCollector, SizeIsThatOfMostFixesOfAStretch) {
  StretchCollector collector;
  for (int i = 0; i < 3 * kRunningMeanFixes + 10; ++i) {
    const bool second = i >= kRunningMeanFixes && i < 2 * kRunningMeanFixes;
    const bool outlier = i % kRunningMeanFixes < 14;  // nearly half of each
    collector.add(i, outlier ? 1e6 : 2.3659738843753377 * (second ? 25 : 1));
  }
  const StretchConsistency s = collector.result();
  EXPECT_EQ(s.stretches, 3);
  EXPECT_EQ(s.too_large, 1);
  EXPECT_NEAR(s.worst, 5, 1e-9);
  EXPECT_EQ(s.worst_begin_ns, kRunningMeanFixes);
  EXPECT_EQ(s.worst_end_ns, 2 * kRunningMeanFixes - 1);
}

TEST(Consistency, WhiteInnovationsOfTheirCovariance) {
  constexpr int kFixes = 20'000;
  const Consistency c = of_fixes(kFixes, 0, 1);
  const double root = std::sqrt(static_cast<double>(kFixes));
  EXPECT_EQ(c.nis.samples, kFixes);
  EXPECT_TRUE(c.nis.mean_band.holds(c.nis.mean)) << c.nis.mean;
  EXPECT_NEAR(c.nis.inside_share, 0.95, 4 * 0.218 / root);  // sqrt(p (1 - p) / n)
  for (const ResidualStatistics& s : c.innovations) {
    EXPECT_EQ(s.samples, kFixes);
    EXPECT_NEAR(s.mean, 0, 4 / root);
    EXPECT_NEAR(s.sigma, 1, 4 / std::sqrt(2.0) / root);
    EXPECT_NEAR(*s.excess_kurtosis, 0, 4 * std::sqrt(24) / root);
    EXPECT_NEAR(s.inside[0], 0.6827, 4 * 0.465 / root);
    EXPECT_NEAR(s.inside[1], 0.9545, 4 * 0.208 / root);
    EXPECT_NEAR(s.inside[2], 0.9973, 4 * 0.052 / root);
  }
  // Of 300 lags 5 % are outside: sigma 1.3 %.
  EXPECT_NEAR(c.autocorrelation.outside_share, 0.05, 0.05);
  EXPECT_NEAR(c.autocorrelation.white_bound, 1.96 / root, 1e-5);
  EXPECT_EQ(c.autocorrelation.lag.size(), 100U);
  EXPECT_EQ(c.autocorrelation.interval_s, 0.5);
}

TEST(Consistency, HistogramIsTheGaussianDensity) {
  constexpr int kFixes = 20'000;
  const ResidualHistogram h = of_fixes(kFixes, 0, 1).innovations[1].histogram;
  int64_t sum = h.outside;
  for (std::size_t i = 0; i < h.counts.size(); ++i) {
    sum += h.counts[i];
    const double left =
        -ResidualHistogram::kLimit + ResidualHistogram::kWidth * static_cast<double>(i);
    const auto below = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
    const double expected = kFixes * (below(left + ResidualHistogram::kWidth) - below(left));
    EXPECT_NEAR(static_cast<double>(h.counts[i]), expected, 4.5 * std::sqrt(expected) + 2) << left;
  }
  EXPECT_EQ(sum, kFixes);
}

TEST(Consistency, AutocorrelationOfAutoregressiveInnovations) {
  const double a = 0.8;
  const Consistency c = of_fixes(20'000, a, 1);
  for (const std::size_t k : {1U, 2U, 5U, 10U}) {
    // Bartlett: variance of an estimate about (1 + a^2) / (1 - a^2) / n: sigma 0.015.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(c.autocorrelation.lag[k - 1][axis], std::pow(a, k), 0.06) << k;
    }
  }
  EXPECT_GT(c.autocorrelation.outside_share, 0.2);
  // The square of a Gaussian AR(1) has autocorrelation a^2k.
  const double theory = 20'000 * (1 - a * a) / (1 + a * a);
  EXPECT_NEAR(c.nis.effective_samples, theory, 0.3 * theory);
}

/// The band of effective samples holds the mean of coloured innovations; that of all would not.
TEST(Consistency, BandOfCorrelatedInnovationsHoldsTheirMean) {
  int inside = 0;
  int inside_naive = 0;
  constexpr int kTrials = 200;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const Consistency c = of_fixes(1000, 0.95, 1, trial);
    inside += c.nis.mean_band.holds(c.nis.mean);
    inside_naive += mean_nees_band(3, 1000).holds(c.nis.mean);
  }
  // 0.95 less what the estimated autocorrelation costs with some 50 effective samples.
  EXPECT_GT(inside, 0.85 * kTrials);
  EXPECT_LT(inside_naive, 0.6 * kTrials);
}

/// Negative control: covariances that promise too much, and too little.
TEST(Consistency, SigmasOffByAFactorOfTwoAreSeen) {
  for (const double memory : {0.0, 0.9}) {
    const Consistency small = of_fixes(1000, memory, 2);
    EXPECT_GT(small.nis.mean, small.nis.mean_band.high);
    EXPECT_LT(small.nis.inside_share, 0.7);
    EXPECT_NEAR(small.innovations[0].sigma, 2, 0.4);
    const Consistency large = of_fixes(1000, memory, 0.5);
    EXPECT_LT(large.nis.mean, large.nis.mean_band.low);
  }
}

TEST(Consistency, RunningMeanIsOverUsedFixesOnly) {
  std::vector<NormalizedSquare> squares;
  ConsistencyCollector collector(std::numeric_limits<int64_t>::min(),
                                 [&squares](const NormalizedSquare& s) { squares.push_back(s); });
  for (int i = 0; i < 40; ++i) {
    state::FixResult fix;
    fix.t_ns = nanoseconds(i);
    fix.innovation_covariance.setIdentity();
    fix.innovation_n.x() = i == 20 ? 100 : 2;
    if (i == 20) fix.verdict = state::FixVerdict::gated;
    collector.fix(fix);
  }
  ASSERT_EQ(squares.size(), 40U);
  EXPECT_FALSE(squares[20].used);
  EXPECT_NEAR(squares[20].value, 1e4, 1e-8);
  EXPECT_FALSE(squares[29].running_mean);  // the 29th that was used
  EXPECT_NEAR(*squares[30].running_mean, 4, 1e-12);
  EXPECT_NEAR(*squares[39].running_mean, 4, 1e-12);
  EXPECT_EQ(collector.result().nis.samples, 39);
  EXPECT_NEAR(collector.result().nis.mean, 4, 1e-12);
}

TEST(Consistency, StatisticsLeaveOutWhatComesBefore) {
  int seen = 0;
  ConsistencyCollector collector(nanoseconds(10), [&seen](const NormalizedSquare&) { ++seen; });
  for (int t = 0; t < 20; ++t) {
    collector.error(NormalizedKind::velocity, nanoseconds(t),
                    Eigen::Vector3d::Constant(t < 10 ? 9 : 1), Eigen::Matrix3d::Identity());
  }
  EXPECT_EQ(seen, 20);
  const Consistency c = collector.result();
  EXPECT_FALSE(c.position_nees);
  EXPECT_EQ(c.velocity_nees->samples, 10);
  EXPECT_NEAR(c.velocity_nees->mean, 3, 1e-12);
}

/// Chi-square of 30 degrees of freedom at 2.5 and 97.5 %, from tables.
TEST(Consistency, PredictionsArePooledByTheirHorizon) {
  ConsistencyCollector collector(nanoseconds(10));
  for (int t = 9; t < 20; ++t) {
    state::PredictionResult prediction;
    prediction.t_ns = nanoseconds(t);
    prediction.innovation_covariance = 4 * Eigen::Matrix3d::Identity();
    for (const double ahead_s : {30.0, 5.0}) {
      prediction.ahead_s = ahead_s;
      prediction.innovation_n = {ahead_s, 0, 2};
      collector.prediction(prediction);
    }
  }
  const std::vector<PredictionConsistency> predictions = collector.result().predictions;
  ASSERT_EQ(predictions.size(), 2u);
  EXPECT_EQ(predictions[0].ahead_s, 5);
  EXPECT_EQ(predictions[0].samples, 10) << "from the start of the statistics on";
  EXPECT_NEAR(predictions[0].mean_nis, 29.0 / 4, 1e-12);
  EXPECT_NEAR(predictions[0].mean_band.low, 16.791 / 10, 1e-4);
  EXPECT_NEAR(predictions[0].mean_band.high, 46.979 / 10, 1e-4);
  EXPECT_EQ(predictions[1].ahead_s, 30);
  EXPECT_NEAR(predictions[1].mean_nis, 904.0 / 4, 1e-12);
}

TEST(Consistency, OfNothing) {
  const Consistency c = ConsistencyCollector().result();
  EXPECT_EQ(c.nis.samples, 0);
  EXPECT_TRUE(c.autocorrelation.lag.empty());
  EXPECT_FALSE(c.attitude_nees);
  EXPECT_TRUE(c.predictions.empty());
  EXPECT_NEAR(c.single_band.high, 9.348404, 1e-6);  // tables
}

}  // namespace
}  // namespace foucault::evaluation
