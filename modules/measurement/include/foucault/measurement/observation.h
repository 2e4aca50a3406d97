#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>

#include "foucault/state/kalman.h"
#include "foucault/state/layout.h"

namespace foucault::measurement {

/// What the IMU measured about a stamp: means, not compensated; zero if unknown.
struct MeanMotion {
  Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d force_b = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Something that was measured at one stamp, as a function of the state there. One class each; the
/// filter, the smoothers and the graphs use it unchanged.
class Observation {
 public:
  virtual ~Observation() = default;

  /// Of its kind: aids.NAME in the configuration and in metrics.json. A literal, as results keep
  /// it after this is gone.
  virtual std::string_view name() const = 0;

  /// In the local NED of x: r = measured - predicted, H = d predicted / d error, by the blocks of
  /// `layout`, and the covariance R of what was measured. `mean`: about the stamp.
  virtual state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                                      const state::Layout& layout) const = 0;
};

using ObservationPtr = std::shared_ptr<const Observation>;

}  // namespace foucault::measurement
