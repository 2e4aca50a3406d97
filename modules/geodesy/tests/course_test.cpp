#include "foucault/geodesy/course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"

namespace foucault::geodesy {
namespace {

TEST(Course, AzimuthCountsFromNorthOverEast) {
  EXPECT_EQ(azimuth({1, 0, 5}), 0);
  EXPECT_NEAR(azimuth({0, 2, -5}), kPi / 2, 1e-15);
  EXPECT_NEAR(azimuth({-1, -1, 0}), -3 * kPi / 4, 1e-15);
}

TEST(Course, HorizontalSigmaIsTheLargerOne) {
  Eigen::Matrix3d covariance = Eigen::Vector3d(0.04, 0.09, 25).asDiagonal();
  EXPECT_NEAR(horizontal_sigma(covariance), 0.3, 1e-15);
  covariance(0, 0) = 0.16;
  EXPECT_NEAR(horizontal_sigma(covariance), 0.4, 1e-15);
}

/// The vertical does not matter, what is along the way does not either.
TEST(Course, SigmaIsThatOfSampledCourses) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  const Eigen::Vector3d way(12, -9, 3);
  Eigen::Matrix3d root;
  root << 0.02, 0, 0, 0.05, 0.1, 0, 0.3, -0.2, 2;
  double squares = 0;
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d error = root * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
    squares += std::pow(so3::wrap(azimuth(way + error) - azimuth(way)), 2);
  }
  // A sigma of so many samples is good to 0.5 %; three of these.
  const double sigma = course_sigma(root * root.transpose(), way);
  EXPECT_NEAR(std::sqrt(squares / kSamples) / sigma, 1, 0.015);
}

}  // namespace
}  // namespace foucault::geodesy
