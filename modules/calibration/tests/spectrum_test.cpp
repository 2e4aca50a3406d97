#include "foucault/calibration/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "foucault/core/constants.h"

namespace foucault::calibration {
namespace {

constexpr double kSpacing = 0.005;  // [s]
constexpr double kDensity = 0.01;
const std::vector<int> kFirstThree{0, 1, 2};

/// White noise, with sines on the second axis and an offset that is none of it.
Spectrum shaken_at(const std::vector<double>& hertz, double amplitude, int samples, unsigned seed) {
  std::mt19937_64 rng{seed};
  std::normal_distribution<double> normal(0, kDensity / std::sqrt(kSpacing));
  WelchSpectrum welch(kSpacing, 1024);
  for (int k = 0; k < samples; ++k) {
    SixAxes sample = SixAxes::Constant(9.8);
    for (int axis = 0; axis < 6; ++axis) sample[axis] += normal(rng);
    for (const double one : hertz) sample[1] += amplitude * std::sin(2 * kPi * one * k * kSpacing);
    welch.add(sample);
  }
  return welch.spectrum();
}

Spectrum shaken(double hertz, double amplitude, int samples, unsigned seed) {
  return shaken_at({hertz}, amplitude, samples, seed);
}

/// At N^2, whatever the level of the sensor; but for the first bins, which the mean leaves.
TEST(Spectrum, WhiteNoiseLiesAtItsDensity) {
  const Spectrum white = shaken(0, 0, 200000, 1);
  ASSERT_EQ(white.density.size(), 513u);
  EXPECT_NEAR(white.frequency_hz(512), 100, 1e-9);
  EXPECT_EQ(white.segments, 389);
  double mean = 0;
  for (std::size_t bin = 2; bin < 512; ++bin) mean += white.density[bin].mean() / 510;
  EXPECT_NEAR(mean, kDensity * kDensity, 0.01 * kDensity * kDensity);
  EXPECT_TRUE(lines_of(white, kFirstThree, 6).empty());
}

TEST(Spectrum, ALineIsNamedByItsFrequencyAndSize) {
  const Spectrum spectrum = shaken(25.33, 0.1, 60000, 2);
  const std::vector<SpectralLine> lines = lines_of(spectrum, kFirstThree, 6);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].frequency_hz, 25.33, 0.02);
  EXPECT_NEAR(lines[0].rms, 0.1 / std::sqrt(2), 0.05 * 0.1);
  EXPECT_TRUE(lines_of(spectrum, {3, 4, 5}, 6).empty());
}

TEST(Spectrum, LinesBesideEachOtherAreOne) {
  EXPECT_EQ(lines_of(shaken_at({25, 26}, 0.1, 60000, 3), kFirstThree, 6).size(), 1u);
  EXPECT_EQ(lines_of(shaken_at({25, 60}, 0.1, 60000, 3), kFirstThree, 6).size(), 2u);
  EXPECT_EQ(lines_of(shaken_at({25, 60}, 0.1, 60000, 3), kFirstThree, 1).size(), 1u);
}

/// Few segments scatter: their peaks are none. One recording in a hundred may say otherwise.
TEST(Spectrum, NoiseHasNoLines) {
  int named = 0;
  for (unsigned seed = 1; seed <= 100; ++seed)
    if (!lines_of(shaken(0, 0, 5000, seed), kFirstThree, 6).empty()) ++named;
  EXPECT_LE(named, 1);
}

/// A slope of motion is none either.
TEST(Spectrum, ASlopeHasNoLines) {
  std::mt19937_64 rng{5};
  std::normal_distribution<double> normal;
  WelchSpectrum welch(kSpacing, 1024);
  SixAxes walk = SixAxes::Zero();
  for (int k = 0; k < 60000; ++k) {
    for (int axis = 0; axis < 6; ++axis) walk[axis] += normal(rng);
    welch.add(walk);
  }
  EXPECT_TRUE(lines_of(welch.spectrum(), kFirstThree, 6).empty());
}

/// What resonates without being driven is a hump: 20 Hz, damped to a width of 2 Hz.
TEST(Spectrum, AHumpHasNoLines) {
  std::mt19937_64 rng{8};
  std::normal_distribution<double> normal;
  WelchSpectrum welch(kSpacing, 1024);
  const double kept = std::exp(-kPi * 2 * kSpacing);
  const double turn = 2 * kept * std::cos(2 * kPi * 20 * kSpacing);
  SixAxes now = SixAxes::Zero(), before = SixAxes::Zero();
  for (int k = 0; k < 60000; ++k) {
    SixAxes next = turn * now - kept * kept * before;
    for (int axis = 0; axis < 6; ++axis) next[axis] += normal(rng);
    before = now;
    now = next;
    welch.add(now);
  }
  EXPECT_TRUE(lines_of(welch.spectrum(), kFirstThree, 6).empty());
}

TEST(Spectrum, WhatIsInterruptedIsNotJoined) {
  WelchSpectrum welch(kSpacing, 1024);
  for (int k = 0; k < 5000; ++k) {
    if (k % 1000 == 0) welch.interrupt();
    welch.add(SixAxes::Constant(k < 2000 ? 1 : -1));
  }
  EXPECT_EQ(welch.spectrum().segments, 0);
  EXPECT_TRUE(welch.spectrum().density.empty());
  EXPECT_TRUE(lines_of(welch.spectrum(), kFirstThree, 6).empty());
}

}  // namespace
}  // namespace foucault::calibration
