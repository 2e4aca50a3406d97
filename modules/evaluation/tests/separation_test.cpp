#include "foucault/evaluation/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

/// At t [s], north of the equator, with these variances of position.
state::Epoch epoch_at(double t, double north_m, double heading, double variance) {
  state::Epoch epoch;
  epoch.t_ns = nanoseconds(t);
  epoch.position = {north_m / 6335439.327, 0, 0};  // WGS-84's meridian radius at the equator
  epoch.velocity_n = {north_m, 0, 0};
  epoch.q_n_b = so3::from_euler({0, 0, heading});
  epoch.covariance.diagonal().head<9>().setConstant(variance);
  return epoch;
}

struct Separations {
  std::vector<state::Separation> told;
  SeparationCollector collector{state::Mounting(),
                                [this](const state::Separation& s) { told.push_back(s); }};
};

TEST(Separation, IsSmoothedLessForwardWithWhatSmoothingMayChange) {
  Separations s;
  s.collector.forward(epoch_at(1, 5, 3.1, 25));
  s.collector.smoothed(epoch_at(1, 2, -3.1, 16));
  ASSERT_EQ(s.told.size(), 1u);
  EXPECT_NEAR(s.told[0].position_n.x(), -3, 1e-6);
  EXPECT_NEAR(s.told[0].velocity_n.x(), -3, 1e-12);
  EXPECT_NEAR(s.told[0].euler.z(), 2 * M_PI - 6.2, 1e-12) << "the shorter way round";
  EXPECT_NEAR(s.told[0].position_sigma.x(), 3, 1e-12);
  EXPECT_NEAR(s.told[0].euler_sigma.z(), 3, 1e-9);
}

TEST(Separation, IsOfTheSameStamp) {
  Separations s;
  for (const double t : {1.0, 2.0, 3.0}) s.collector.forward(epoch_at(t, t, 0, 4));
  for (const double t : {0.5, 2.0, 2.5}) s.collector.smoothed(epoch_at(t, 0, 0, 1));
  ASSERT_EQ(s.told.size(), 1u);
  EXPECT_EQ(s.told[0].t_ns, nanoseconds(2));
  EXPECT_NEAR(s.told[0].position_n.x(), -2, 1e-6);
}

TEST(Separation, KeepsAtMostTwentyEpochsASecond) {
  Separations s;
  for (int i = 0; i <= 200; ++i) s.collector.forward(epoch_at(i * 0.005, 0, 0, 4));
  for (int i = 0; i <= 200; ++i) s.collector.smoothed(epoch_at(i * 0.005, 0, 0, 1));
  EXPECT_EQ(s.told.size(), 21u);
}

TEST(Separation, RootMeanSquaresAreFromTheStartOfTheStatisticsOn) {
  Separations s;
  s.collector.statistics_from(nanoseconds(2));
  const double north[] = {100, 3, 4};
  for (int i = 0; i < 3; ++i) s.collector.forward(epoch_at(i + 1, north[i], 0, 4));
  for (int i = 0; i < 3; ++i) s.collector.smoothed(epoch_at(i + 1, 0, 0, 1));
  const SeparationMetrics metrics = s.collector.metrics();
  EXPECT_EQ(metrics.samples, 2);
  EXPECT_NEAR(metrics.position_rms_n.x(), std::sqrt(12.5), 1e-6);
  EXPECT_NEAR(metrics.velocity_rms_n.x(), std::sqrt(12.5), 1e-12);
  EXPECT_EQ(metrics.position_rms_n.y(), 0);
}

TEST(Separation, SigmasThatGrewLeaveNone) {
  Separations s;
  s.collector.forward(epoch_at(1, 0, 0, 4));
  s.collector.smoothed(epoch_at(1, 0, 0, 4.1));
  ASSERT_EQ(s.told.size(), 1u);
  EXPECT_EQ(s.told[0].position_sigma, Eigen::Vector3d::Zero());
}

/// Of an estimate from many measurements and one from the first of them: the covariance of their
/// difference is that of the one less that of the other, and its square a chi-square of three.
TEST(SeparationSquare, IsOfThreeDegreesOfFreedomIfTheCovariancesAreRight) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)); };
  Eigen::Matrix3d root;
  root << 1, 0, 0, 0.7, 0.3, 0, -2, 0.1, 0.5;
  const Eigen::Matrix3d first = root * root.transpose();
  const int more = 4;
  double sum = 0;
  constexpr int kSeeds = 4000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Eigen::Vector3d early = root * draw();
    Eigen::Vector3d all = early;
    for (int i = 1; i < more; ++i) all += root * draw();
    all /= more;
    sum += *separation_square(all - early, first, first / more);
  }
  EXPECT_NEAR(sum / kSeeds, 3, 4 * std::sqrt(6.0 / kSeeds));  // 4 sigmas of the mean
}

TEST(SeparationSquare, WhereNothingIsLeftATenthOfASigmaIsRounding) {
  const Eigen::Matrix3d P = Eigen::Matrix3d::Identity();
  EXPECT_NEAR(*separation_square({0.1, 0, 0}, P, P), 1, 1e-9);
  EXPECT_NEAR(*separation_square({0.1, 0, 0}, P, 1.1 * P), 1, 1e-9) << "sigmas that grew";
  EXPECT_FALSE(separation_square({1, 0, 0}, Eigen::Matrix3d::Zero(), P));
}

TEST(Separation, SizesAreOneIfTheCovariancesAreRight) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const auto size_of = [&](double factor) {
    Separations s;
    constexpr int kEpochs = 2000;
    for (int t = 0; t < kEpochs; ++t) s.collector.forward(epoch_at(t, 0, 0, 25e-4));
    for (int t = 0; t < kEpochs; ++t) {
      const double sigma = 0.03 * factor;  // of what is left of 5 after 4 hundredths
      state::Epoch epoch = epoch_at(t, 0, 0, 16e-4);
      const auto draw = [&] { return Eigen::Vector3d(normal(rng), normal(rng), normal(rng)); };
      epoch.velocity_n = sigma * draw();
      epoch.q_n_b = so3::exp(sigma * draw());
      s.collector.smoothed(epoch);
    }
    return s.collector.metrics();
  };
  // A median of 2000 squares is known to 2.5 %, its root to half of that.
  EXPECT_NEAR(size_of(1).velocity_size, 1, 0.05);
  EXPECT_NEAR(size_of(1).attitude_size, 1, 0.05);
  EXPECT_NEAR(size_of(4).attitude_size, 4, 0.2);
  EXPECT_EQ(size_of(1).position_size, 0) << "it stayed";
}

}  // namespace
}  // namespace foucault::evaluation
