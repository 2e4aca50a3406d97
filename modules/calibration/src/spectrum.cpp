#include "foucault/calibration/spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"

namespace foucault::calibration {
namespace {

constexpr std::size_t kWindowHalf = 2;  ///< bins to either side that a line under Hann's window has
constexpr std::size_t kBeyond = 2 * kWindowHalf;

/// What surrounds a bin, on a slope too.
double beside(const std::vector<double>& density, std::size_t bin) {
  constexpr std::size_t kLeast = 8;
  const std::size_t reach = std::max(kLeast, bin / 4);
  const std::size_t begin = bin > reach ? bin - reach : 1;
  const std::size_t end = std::min(density.size(), bin + reach + 1);
  const auto at = [&](std::size_t i) { return density.begin() + static_cast<std::ptrdiff_t>(i); };
  return median(std::vector<double>(at(begin), at(end)));
}

/// And no hump: it has fallen by half where a line under the window has ended.
bool is_peak(const std::vector<double>& density, std::size_t bin) {
  const double here = density[bin];
  return here >= density[bin - 1] && here > density[bin + 1] &&
         here > 2 * std::max(density[bin - kBeyond], density[bin + kBeyond]);
}

/// The top of the parabola through three logarithms, in bins from the middle one.
double top(double before, double middle, double after) {
  const double a = std::log(before), b = std::log(middle), c = std::log(after);
  return 0.5 * (a - c) / (a - 2 * b + c);
}

/// Without those beside a stronger one: an engine's speed is never quite the same.
std::vector<SpectralLine> apart(const std::vector<SpectralLine>& strongest_first,
                                std::size_t most) {
  constexpr double kBeside = 0.1;  // of the frequency
  std::vector<SpectralLine> kept;
  for (const SpectralLine& line : strongest_first) {
    const auto is_beside = [&](const SpectralLine& other) {
      return std::abs(other.frequency_hz - line.frequency_hz) < kBeside * other.frequency_hz;
    };
    if (kept.size() < most && std::none_of(kept.begin(), kept.end(), is_beside))
      kept.push_back(line);
  }
  return kept;
}

SpectralLine line_at(const Spectrum& spectrum, const std::vector<double>& density, std::size_t bin,
                     double base) {
  double power = 0;
  for (std::size_t i = bin - kWindowHalf; i <= bin + kWindowHalf; ++i)
    power += std::max(0.0, density[i] - base);
  const double offset = top(density[bin - 1], density[bin], density[bin + 1]);
  return {(static_cast<double>(bin) + offset) * spectrum.step_hz,
          std::sqrt(2 * power * spectrum.step_hz), density[bin] / base};
}

}  // namespace

WelchSpectrum::WelchSpectrum(double interval_s, std::size_t length)
    : interval_s_(interval_s), sum_(length / 2 + 1, SixAxes::Zero()) {
  for (std::size_t i = 0; i < length; ++i) {
    const double x = 2 * kPi * static_cast<double>(i) / static_cast<double>(length);
    window_.push_back(0.5 * (1 - std::cos(x)));
    window_power_ += window_.back() * window_.back();
  }
}

void WelchSpectrum::add(const SixAxes& sample) {
  segment_.push_back(sample);
  if (segment_.size() < window_.size()) return;
  take_segment();
  segment_.erase(segment_.begin(),
                 segment_.begin() + static_cast<std::ptrdiff_t>(window_.size() / 2));
}

void WelchSpectrum::take_segment() {
  SixAxes mean = SixAxes::Zero();
  for (const SixAxes& sample : segment_) mean += sample;
  mean /= static_cast<double>(segment_.size());
  Eigen::FFT<double> fft;
  std::vector<double> time(segment_.size());
  std::vector<std::complex<double>> frequency;
  for (int axis = 0; axis < 6; ++axis) {
    for (std::size_t i = 0; i < time.size(); ++i)
      time[i] = window_[i] * (segment_[i][axis] - mean[axis]);
    fft.fwd(frequency, time);
    for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i][axis] += std::norm(frequency[i]);
  }
  ++segments_;
}

Spectrum WelchSpectrum::spectrum() const {
  Spectrum out;
  out.step_hz = 1 / (interval_s_ * static_cast<double>(window_.size()));
  out.segments = segments_;
  if (segments_ == 0) return out;
  out.density = sum_;
  for (SixAxes& bin : out.density)
    bin *= interval_s_ / (window_power_ * static_cast<double>(segments_));
  return out;
}

std::vector<SpectralLine> lines_of(const Spectrum& spectrum, const std::vector<int>& axes,
                                   std::size_t most) {
  constexpr double kStandsOut = 4, kSigmas = 6;
  std::vector<double> density;
  for (const SixAxes& bin : spectrum.density) density.push_back(bin(axes).sum());
  // Overlapping segments under Hann's window are worth 0.95 of as many independent ones.
  const double means =
      0.95 * static_cast<double>(spectrum.segments) * static_cast<double>(axes.size());
  std::vector<SpectralLine> lines;
  for (std::size_t bin = kBeyond; bin + kBeyond < density.size(); ++bin) {
    if (!is_peak(density, bin)) continue;
    const double base = beside(density, bin);
    if (density[bin] > base * std::max(kStandsOut, 1 + kSigmas / std::sqrt(means)))
      lines.push_back(line_at(spectrum, density, bin, base));
  }
  std::sort(lines.begin(), lines.end(),
            [](const SpectralLine& a, const SpectralLine& b) { return a.ratio > b.ratio; });
  return apart(lines, most);
}

}  // namespace foucault::calibration
