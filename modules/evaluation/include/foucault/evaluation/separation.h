#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <functional>

#include "foucault/core/measurement.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/separation.h"

namespace foucault::evaluation {

/// Root mean squares of smoothed less forward, from the start of the statistics on.
struct SeparationMetrics {
  int64_t samples = 0;
  Eigen::Vector3d position_rms_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Vector3d velocity_rms_n = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d euler_rms = Eigen::Vector3d::Zero();       ///< roll, pitch, heading [rad]
};

/// Compares the epochs of a smoother with those of its forward run, at most twenty a second: of
/// these the forward run's are kept, in 250 bytes each, until the smoothed ones come.
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
    Eigen::Vector3d position_sigma, velocity_sigma, euler_sigma;
  };

  void add(const state::Separation& separation);

  state::Mounting mounting_;
  Callback callback_;
  int64_t from_ns_ = 0;
  std::deque<Kept> kept_;
  SeparationMetrics sums_;  ///< of squares
};

}  // namespace foucault::evaluation
