#include "foucault/evaluation/outage_consistency.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "foucault/core/time.h"
#include "foucault/evaluation/outage_join.h"

namespace foucault::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Outages of a given length, sampled every second; the errors have `scale` times the sigmas that
/// were given for them.
ExperimentResult experiment(const std::string& method, int outages, double length_s, double scale) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const auto draw = [&](double sigma) { return sigma * normal(rng); };
  ExperimentResult result;
  result.recording = "trip";
  result.method = method;
  for (int i = 0; i < outages; ++i) {
    const Outage outage{i, 0, nanoseconds(length_s)};
    std::vector<DriftSample> samples;
    for (double t = 1; t <= length_s; ++t) {
      const double sigma = 0.01 * t * t;
      const Eigen::Vector3d error(draw(scale * sigma), draw(scale * sigma), draw(sigma));
      const Eigen::Matrix3d covariance = sigma * sigma * Eigen::Matrix3d::Identity();
      samples.push_back({t, error, normalized_squares(error, covariance)});
    }
    result.run.drifts.push_back(outage_drift(outage, samples, default_drift_marks_s()));
  }
  return result;
}

std::vector<MethodNormalizedDrifts> normalized(const std::vector<ExperimentResult>& results) {
  return normalized_drifts(group_outages(results, Grouping::recording));
}

TEST(NormalizedDrifts, TellRightSigmasFromWrongOnes) {
  const auto methods =
      normalized({experiment("right", 100, 60, 1), experiment("sure", 100, 60, 2)});
  ASSERT_EQ(methods.size(), 2u);
  EXPECT_EQ(times_of(methods), (std::vector<std::string>{"5 s", "15 s", "30 s", "60 s", "middle"}));
  for (const NormalizedDrift& drift : methods[0].times) {
    EXPECT_EQ(drift.horizontal.outages, 100);
    // Four sigmas of the mean of 100 squares of 2 and of 1 degrees of freedom.
    EXPECT_NEAR(drift.horizontal.mean, 1, 0.4) << time_text(drift);
    EXPECT_NEAR(drift.vertical.mean, 1, 0.57) << time_text(drift);
  }
  for (const NormalizedDrift& drift : methods[1].times) {
    EXPECT_GT(drift.horizontal.mean, drift.horizontal.band.high) << time_text(drift);
    EXPECT_NEAR(drift.horizontal.mean, 2 * 2, 4 * 0.4) << time_text(drift);
    EXPECT_NEAR(drift.vertical.mean, 1, 0.57) << time_text(drift);
  }
}

/// Chi-square of 40 and of 20 degrees of freedom at 2.5 and 97.5 %, from tables.
TEST(NormalizedDrifts, BandsAreThoseOfTheirDegreesOfFreedom) {
  const NormalizedDrift drift = normalized({experiment("a", 20, 60, 1)})[0].times[0];
  EXPECT_NEAR(drift.horizontal.band.low, 24.433 / 40, 1e-4);
  EXPECT_NEAR(drift.horizontal.band.high, 59.342 / 40, 1e-4);
  EXPECT_NEAR(drift.vertical.band.low, 9.591 / 20, 1e-4);
  EXPECT_NEAR(drift.vertical.band.high, 34.170 / 20, 1e-4);
}

TEST(NormalizedDrifts, OnlyTimesThatOutagesReach) {
  const auto methods = normalized({experiment("a", 3, 20, 1)});
  EXPECT_EQ(times_of(methods), (std::vector<std::string>{"5 s", "15 s", "middle"}));
  EXPECT_EQ(methods[0].times.back().after_s, 10);
}

TEST(NormalizedDrifts, OutagesWithoutSigmasAreNotCounted) {
  ExperimentResult result = experiment("a", 3, 20, 1);
  for (DriftSample& sample : result.run.drifts[1].samples) sample.normalized.horizontal = kNaN;
  const NormalizedDrift drift = normalized({result})[0].times[0];
  EXPECT_EQ(drift.horizontal.outages, 2);
  EXPECT_EQ(drift.vertical.outages, 3);
}

TEST(NormalizedDrifts, TableNamesTheSideOfTheBand) {
  const TextTable table =
      normalized_drift_table(normalized({experiment("sure", 100, 20, 3)}), "Recording");
  EXPECT_EQ(table.header, (std::vector<std::string>{"Recording", "Method", "Direction", "Outages",
                                                    "5 s", "15 s", "middle"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][3], "100");
  EXPECT_NE(table.rows[0][4].find("] above"), std::string::npos) << table.rows[0][4];
  EXPECT_EQ(table.rows[1][4].back(), ']') << table.rows[1][4];
}

TEST(PooledReturns, CountThoseThatNeverSettle) {
  ExperimentResult result = experiment("a", 4, 20, 1);
  result.run.drifts[0].after_return = ReturnError{3, 5, 1};
  result.run.drifts[1].after_return = ReturnError{4, 100, std::nullopt};
  result.run.drifts[2].after_return = ReturnError{0, 0, 4};
  const auto pooled = pooled_returns(group_outages({result}, Grouping::recording));
  ASSERT_EQ(pooled.size(), 1u);
  EXPECT_EQ(pooled[0].outages, 3);  // no fix follows the last one
  EXPECT_NEAR(pooled[0].rms_horizontal, 5 / std::sqrt(3), 1e-12);
  EXPECT_EQ(pooled[0].max_horizontal, 100);
  EXPECT_EQ(pooled[0].never_settled, 1);
  EXPECT_EQ(pooled[0].median_settled_s, 2.5);
  EXPECT_EQ(pooled[0].max_settled_s, 4);
  const TextTable table = return_table(pooled, "Recording");
  EXPECT_EQ(table.rows[0],
            (std::vector<std::string>{"trip", "a", "3", "2.887", "100.000", "2.5", "4.0", "1"}));
}

TEST(PooledReturns, WithoutAReturnThereIsNoEntry) {
  EXPECT_TRUE(
      pooled_returns(group_outages({experiment("a", 4, 20, 1)}, Grouping::recording)).empty());
}

}  // namespace
}  // namespace foucault::evaluation
