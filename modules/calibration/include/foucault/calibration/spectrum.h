#pragma once

#include <cstdint>
#include <vector>

#include "foucault/calibration/allan.h"

namespace foucault::calibration {

/// Power spectral density, two-sided: white noise of density N lies at N^2 everywhere.
struct Spectrum {
  double step_hz = 0;            ///< bins are at whole multiples of it, from the first
  std::vector<SixAxes> density;  ///< (U / sqrt(Hz))^2, U the unit of a sensor
  int64_t segments = 0;

  double frequency_hz(std::size_t bin) const { return step_hz * static_cast<double>(bin); }
};

/// Welch's: segments that overlap by half, less their means, under Hann's window. Of whole segments
/// between interruptions. Memory is constant.
class WelchSpectrum {
 public:
  /// `length`: of a segment, a power of two.
  WelchSpectrum(double interval_s, std::size_t length);

  void add(const SixAxes& sample);
  /// What comes next does not follow on what came before.
  void interrupt() { segment_.clear(); }
  /// No density of no segment.
  Spectrum spectrum() const;

 private:
  void take_segment();

  double interval_s_;
  std::vector<double> window_;
  double window_power_ = 0;
  std::vector<SixAxes> segment_;
  std::vector<SixAxes> sum_;
  int64_t segments_ = 0;
};

/// A narrow line that stands out: vibration, or its alias.
struct SpectralLine {
  double frequency_hz = 0;
  double rms = 0;    ///< of all axes together, above what is beside it [unit of the sensor]
  double ratio = 0;  ///< its density over that beside it
};

/// Lines of some axes together, at most `most`, the strongest first: peaks four times as high as
/// the median of what is beside them (a quarter of the frequency to either side) and six sigmas of
/// the mean over segments above it, no wider than the window makes them; of those within a tenth of
/// their frequency the strongest.
std::vector<SpectralLine> lines_of(const Spectrum& spectrum, const std::vector<int>& axes,
                                   std::size_t most);

}  // namespace foucault::calibration
