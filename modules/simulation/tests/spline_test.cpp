#include "foucault/simulation/spline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace foucault::simulation {
namespace {

std::vector<Eigen::Vector3d> random_controls(int count) {
  std::mt19937 rng{42};
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> controls;
  for (int i = 0; i < count; ++i) controls.emplace_back(uniform(rng), uniform(rng), uniform(rng));
  return controls;
}

TEST(QuinticSpline, DerivativesAreThoseOfTheValue) {
  const QuinticSpline spline(0.5, random_controls(20));
  // Central differences, error h^2/6 times a third derivative of about 10^2: 2e-9.
  const double h = 1e-5;
  for (double t = 0.01; t < spline.duration(); t += 0.0137) {
    const QuinticSpline::Sample before = spline.at(t - h), here = spline.at(t),
                                after = spline.at(t + h);
    EXPECT_LT(((after.value - before.value) / (2 * h) - here.rate).norm(), 1e-7);
    EXPECT_LT(((after.rate - before.rate) / (2 * h) - here.acceleration).norm(), 1e-6);
  }
}

TEST(QuinticSpline, IsFourTimesDifferentiableAtKnots) {
  const QuinticSpline spline(0.5, random_controls(20));
  // Second differences of the acceleration: the fourth derivative from either side of a knot. They
  // differ by h times the jump of the fifth derivative.
  const double h = 1e-3;
  const auto fourth = [&](double t) -> Eigen::Vector3d {
    return (spline.at(t + h).acceleration - 2 * spline.at(t).acceleration +
            spline.at(t - h).acceleration) /
           (h * h);
  };
  for (int knot = 1; knot < 14; ++knot) {
    const double t = 0.5 * knot;
    const double scale = 10 / std::pow(0.5, 5);
    EXPECT_LT((fourth(t + h) - fourth(t - h)).norm(), 4 * h * scale);
  }
}

TEST(QuinticSpline, ReproducesALineThroughItsControls) {
  std::vector<Eigen::Vector3d> controls;
  for (int k = 0; k < 12; ++k) {
    controls.push_back(Eigen::Vector3d(1e6, -3, 0) + (k - 2) * 2.0 * Eigen::Vector3d(250, 1, -2));
  }
  const QuinticSpline spline(2.0, controls);
  EXPECT_DOUBLE_EQ(spline.duration(), 14);
  for (double t = 0; t <= 14; t += 0.7) {
    const QuinticSpline::Sample sample = spline.at(t);
    EXPECT_LT((sample.value - Eigen::Vector3d(1e6 + 250 * t, -3 + t, -2 * t)).norm(), 1e-9);
    EXPECT_LT((sample.rate - Eigen::Vector3d(250, 1, -2)).norm(), 1e-12);
    EXPECT_LT(sample.acceleration.norm(), 1e-12);
  }
}

TEST(QuinticSpline, EqualControlsAreExactRest) {
  const QuinticSpline spline(0.5, std::vector<Eigen::Vector3d>(9, {0.1, 1e6 / 3, -7}));
  for (double t = 0; t < 2; t += 0.013) {
    EXPECT_EQ(spline.at(t).value, Eigen::Vector3d(0.1, 1e6 / 3, -7));
    EXPECT_EQ(spline.at(t).rate, Eigen::Vector3d::Zero());
    EXPECT_EQ(spline.at(t).acceleration, Eigen::Vector3d::Zero());
  }
}

TEST(QuinticSpline, RejectsWhatIsNoSpline) {
  EXPECT_THROW(QuinticSpline(0.5, random_controls(5)), std::invalid_argument);
  EXPECT_THROW(QuinticSpline(0, random_controls(8)), std::invalid_argument);
  EXPECT_EQ(QuinticSpline::controls_for(10, 0.5), 25u);
}

}  // namespace
}  // namespace foucault::simulation
