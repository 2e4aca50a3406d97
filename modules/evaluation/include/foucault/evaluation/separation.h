#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/separation.h"

namespace foucault::evaluation {

/// Smoothed less forward, squared by its covariance P_f - P_s: chi-square of three degrees of
/// freedom if both are right. Where smoothing leaves more than 0.995 of a forward sigma, what it
/// changes is below a tenth of that: rounding and linearization are taken to be that large. None if
/// P_f is not positive definite.
std::optional<double> separation_square(const Eigen::Vector3d& difference,
                                        const Eigen::Matrix3d& forward,
                                        const Eigen::Matrix3d& smoothed);

/// Root mean squares of smoothed less forward, from the start of the statistics on. A size is the
/// root of the median square by the covariance over that of chi-square of three degrees: 1 if the
/// covariances are right, 0 if there are no samples.
struct SeparationMetrics {
  int64_t samples = 0;
  Eigen::Vector3d position_rms_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Vector3d velocity_rms_n = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d euler_rms = Eigen::Vector3d::Zero();       ///< roll, pitch, heading [rad]
  double position_size = 0;
  double velocity_size = 0;
  double attitude_size = 0;  ///< of the IMU
};

/// Compares the epochs of a smoother with those of its forward run, at most twenty a second: of
/// these the forward run's are kept, in 300 bytes each, until the smoothed ones come.
class SeparationCollector {
 public:
  using Callback = std::function<void(const state::Separation&)>;

  SeparationCollector(const state::Mounting& mounting, Callback callback);

  /// Metrics count from there on.
  void statistics_from(int64_t t_ns) { from_ns_ = t_ns; }
  void forward(const state::Epoch& epoch);
  void smoothed(const state::Epoch& epoch);
  SeparationMetrics metrics() const;

 private:
  struct Kept {
    ReferencePose pose;
    Eigen::Vector3f euler_sigma;
    Eigen::Quaternionf q_n_b;
    std::array<Eigen::Matrix<float, 6, 1>, 3> covariances;  ///< lower triangles, in order of blocks
  };

  void add(const state::Separation& separation);
  void add_squares(const Kept& forward, const state::Epoch& smoothed,
                   const state::Separation& separation);

  state::Mounting mounting_;
  Callback callback_;
  int64_t from_ns_ = 0;
  std::deque<Kept> kept_;
  SeparationMetrics sums_;                     ///< of squares
  std::array<std::vector<float>, 3> squares_;  ///< by the covariance, in order of blocks
};

}  // namespace foucault::evaluation
