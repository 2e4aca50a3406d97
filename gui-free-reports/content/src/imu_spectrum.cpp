#include "imu_spectrum.h"

#include <cmath>
#include <complex>
#include <utility>

namespace foucault::content {

namespace {

using Complex = std::complex<double>;

/// Discrete Fourier transform in place (Cooley and Tukey, radix 2); the size is a power of two.
void transform(std::vector<Complex>& values) {
  const size_t size = values.size();
  for (size_t i = 1, j = 0; i < size; ++i) {
    size_t bit = size / 2;
    for (; (j & bit) != 0; bit /= 2) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(values[i], values[j]);
  }
  for (size_t length = 2; length <= size; length *= 2) {
    const Complex turn = std::polar(1.0, -2 * M_PI / static_cast<double>(length));
    for (size_t begin = 0; begin < size; begin += length) {
      Complex phase = 1;
      for (size_t k = begin; k < begin + length / 2; ++k, phase *= turn) {
        const Complex odd = phase * values[k + length / 2];
        values[k + length / 2] = values[k] - odd;
        values[k] += odd;
      }
    }
  }
}

double hann(size_t i) {
  return 0.5 - 0.5 * std::cos(2 * M_PI * static_cast<double>(i) / ImuSpectrum::kLength);
}

constexpr double kMeanSquareOfHann = 0.375;

}  // namespace

void ImuSpectrum::add(double step, const Sample& sample) {
  constexpr double kGap = 1.7;  // of the mean step
  const double usual =
      stretch_.size() > 1 ? stretch_time_ / static_cast<double>(stretch_.size() - 1) : step;
  if (!sample.allFinite() || !(step > 0) || step > kGap * usual) {
    stretch_.clear();
    stretch_time_ = 0;
    if (!sample.allFinite()) return;
  } else if (!stretch_.empty()) {
    stretch_time_ += step;
  }
  stretch_.push_back(sample);
  if (stretch_.size() == kLength) finish_stretch();
}

/// Two real signals make one complex transform.
void ImuSpectrum::finish_stretch() {
  Sample mean = Sample::Zero();
  for (const Sample& sample : stretch_) mean += sample / static_cast<double>(kLength);
  std::vector<Complex> values(kLength);
  for (Eigen::Index pair = 0; pair < 3; ++pair) {
    for (size_t i = 0; i < kLength; ++i) {
      const Sample rest = hann(i) * (stretch_[i] - mean);
      values[i] = {rest[2 * pair], rest[2 * pair + 1]};
    }
    transform(values);
    for (size_t k = 1; k <= kLength / 2; ++k) {
      const Complex mirrored = std::conj(values[kLength - k]);
      const auto column = static_cast<Eigen::Index>(k - 1);
      power_(2 * pair, column) += std::norm(0.5 * (values[k] + mirrored));
      power_(2 * pair + 1, column) += std::norm(0.5 * (values[k] - mirrored));
    }
  }
  ++stretches_;
  time_ += stretch_time_ * static_cast<double>(kLength) / static_cast<double>(kLength - 1);
  stretch_.clear();
  stretch_time_ = 0;
}

ImuSpectrum::Density ImuSpectrum::density() const {
  Density density;
  if (stretches_ == 0) return density;
  const double rate = static_cast<double>(stretches_ * kLength) / time_;
  density.signal.resize(6);
  const double scale = 2 / (rate * kLength * kMeanSquareOfHann * static_cast<double>(stretches_));
  for (size_t k = 1; k <= kLength / 2; ++k) {
    density.frequency.push_back(rate * static_cast<double>(k) / kLength);
    for (Eigen::Index signal = 0; signal < 6; ++signal) {
      density.signal[static_cast<size_t>(signal)].push_back(
          std::sqrt(scale * power_(signal, static_cast<Eigen::Index>(k - 1))));
    }
  }
  return density;
}

}  // namespace foucault::content
