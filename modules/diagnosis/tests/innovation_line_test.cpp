#include "foucault/diagnosis/innovation_line.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;

/// Ten seconds of them, with a sigma of 0.1 m.
InnovationSamples samples(const std::function<Vector3d(double)>& value) {
  InnovationSamples out;
  for (int t = 0; t <= 10; ++t) {
    out.push_back({nanoseconds(t), value(t), Vector3d::Constant(0.01), 0});
  }
  return out;
}

std::function<Vector3d(double)> noise(double sigma) {
  auto rng = std::make_shared<std::mt19937>(42);
  return [=](double) {
    std::normal_distribution<double> normal(0, sigma);
    return Vector3d(normal(*rng), normal(*rng), normal(*rng));
  };
}

TEST(InnovationLine, IsTheLineThatTheyLieOn) {
  const auto value = [](double t) { return Vector3d(1 + 0.5 * t, -t, 3); };
  const InnovationLine line = fit_line(samples(value), Vector3d::Constant(0.04));
  EXPECT_TRUE(line.offset_n.isApprox(value(10), 1e-12));
  EXPECT_TRUE(line.rate_n.isApprox(Vector3d(0.5, -1, 0), 1e-12));
  EXPECT_TRUE(line.at(nanoseconds(20)).isApprox(value(20), 1e-12));
  // Sum of squares about the middle of 11 seconds: 110; 5 s from there to the end.
  EXPECT_NEAR(line.rate_variance_n.x(), 0.01 / 110 + 0.04, 1e-12);
  EXPECT_NEAR(line.offset_variance_n.x(), 0.01 * (1.0 / 11 + 25.0 / 110), 1e-12);
  EXPECT_NEAR(line.variance_at(nanoseconds(12)).x(),
              line.offset_variance_n.x() + 4 * line.rate_variance_n.x(), 1e-12);
}

TEST(InnovationLine, DriftsBeyondFourSigmas) {
  InnovationLine line;
  line.rate_variance_n = Vector3d::Constant(0.0009);
  line.rate_n = {0, 0.19, 0};
  const Vector3d velocity_variance = Vector3d::Constant(0.0016);  // with the above 0.05 m/s
  EXPECT_FALSE(line.drifts(velocity_variance));
  line.rate_n.y() = -0.21;
  EXPECT_TRUE(line.drifts(velocity_variance));
}

TEST(InnovationLine, HoldsItsNoiseAndTheBendOfAnAcceleration) {
  const InnovationSamples noisy = samples(noise(0.1));
  EXPECT_TRUE(lie_on(noisy, fit_line(noisy, Vector3d::Zero()), 0));
  const InnovationSamples wild = samples(noise(1));
  EXPECT_FALSE(lie_on(wild, fit_line(wild, Vector3d::Zero()), 0));
  const InnovationSamples bent = samples([](double t) { return Vector3d(0.05 * t * t, 0, 0); });
  const InnovationLine line = fit_line(bent, Vector3d::Zero());
  EXPECT_FALSE(lie_on(bent, line, 0.001));
  EXPECT_TRUE(lie_on(bent, line, 0.1));
}

TEST(Innovations, ScatterAboutZeroOrDoNot) {
  EXPECT_TRUE(scatter_about_zero(samples(noise(1))));
  EXPECT_FALSE(scatter_about_zero(samples(noise(10))));  // no receiver's
  const auto scatter = noise(1);
  EXPECT_FALSE(scatter_about_zero(
      samples([&](double t) { return Vector3d(scatter(t) + Vector3d(5, 0, 0)); })));
}

TEST(Innovations, AreSmoothOrNoise) {
  EXPECT_FALSE(are_smooth(samples(noise(1))));
  EXPECT_TRUE(are_smooth(samples([](double t) { return Vector3d(t * t, 0, 0); })));
}

}  // namespace
}  // namespace foucault::diagnosis
