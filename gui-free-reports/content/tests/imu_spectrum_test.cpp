#include "imu_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace foucault::content {
namespace {

constexpr double kStep = 0.005;

/// White noise of a density n has a standard deviation n sqrt(rate / 2) a sample.
TEST(ImuSpectrum, WhiteNoiseHasItsDensityAtEveryFrequency) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  ImuSpectrum spectrum;
  for (int i = 0; i < 200 * 1024; ++i) {
    ImuSpectrum::Sample sample;
    for (int k = 0; k < 6; ++k) sample[k] = 3 + (k + 1) * normal(rng) * std::sqrt(0.5 / kStep);
    spectrum.add(kStep, sample);
  }
  const ImuSpectrum::Density density = spectrum.density();
  ASSERT_EQ(spectrum.stretches(), 200U);
  EXPECT_NEAR(density.frequency.back(), 100, 1e-6);
  for (size_t k = 0; k < 6; ++k) {
    double sum = 0;
    for (const double value : density.signal[k]) sum += value * value;
    const double mean = std::sqrt(sum / static_cast<double>(density.frequency.size()));
    EXPECT_NEAR(mean / static_cast<double>(k + 1), 1, 0.02) << "5 sigma of 100 000 samples";
  }
}

TEST(ImuSpectrum, AToneStandsWhereItIs) {
  ImuSpectrum spectrum;
  for (int i = 0; i < 3 * 1024; ++i) {
    ImuSpectrum::Sample sample = ImuSpectrum::Sample::Zero();
    sample[4] = std::sin(2 * M_PI * 25 * kStep * i);
    spectrum.add(kStep, sample);
  }
  const ImuSpectrum::Density density = spectrum.density();
  const std::vector<double>& signal = density.signal[4];
  const auto top = std::max_element(signal.begin(), signal.end()) - signal.begin();
  EXPECT_NEAR(density.frequency[static_cast<size_t>(top)], 25, 0.2);
  EXPECT_LT(density.signal[5][static_cast<size_t>(top)], 1e-9) << "none leaks into its partner";
}

TEST(ImuSpectrum, NoStretchGoesOverAGap) {
  ImuSpectrum spectrum;
  for (int i = 0; i < 1500; ++i) {
    spectrum.add(i == 800 ? 10 * kStep : kStep, ImuSpectrum::Sample::Zero());
  }
  EXPECT_EQ(spectrum.stretches(), 0U);
  EXPECT_TRUE(spectrum.density().frequency.empty());
}

}  // namespace
}  // namespace foucault::content
