#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace foucault::content {

/// Power spectral density of the six signals of an IMU by Welch's method: means of periodograms of
/// stretches without a gap, each with its mean taken out, under a Hann window.
class ImuSpectrum {
 public:
  using Sample = Eigen::Matrix<double, 6, 1>;
  static constexpr size_t kLength = 1024;  ///< samples of a stretch

  /// `step` [s]: of this sample from the one before.
  void add(double step, const Sample& sample);

  size_t stretches() const { return stretches_; }
  struct Density {
    std::vector<double> frequency;            ///< [Hz], without that of zero
    std::vector<std::vector<double>> signal;  ///< [unit/sqrt(Hz)], a column a signal
  };
  /// Empty without a whole stretch.
  Density density() const;

 private:
  void finish_stretch();

  std::vector<Sample> stretch_;
  double stretch_time_ = 0;
  size_t stretches_ = 0;
  double time_ = 0;  ///< of all stretches [s]
  Eigen::Matrix<double, 6, Eigen::Dynamic> power_ =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, kLength / 2);
};

}  // namespace foucault::content
