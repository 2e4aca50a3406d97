#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "foucault/state/layout.h"

namespace foucault::state {

/// What the vehicle's axes are turned by from those that were told: R_v_told = Rz(heading)
/// Ry(pitch), the angles of the block `mounting`; identity where it is not estimated. Roll stays as
/// it was told, in the sense of roll, pitch and heading of an IMU in its vehicle: a rotation vector
/// (0, pitch, heading) would roll it by half their product, 1 mrad at 2 and 3 deg.
class MountingTurn {
 public:
  /// mounting: the block as it is estimated, or null.
  MountingTurn(const SlowVector& slow, const SlowBlock* mounting);

  const Eigen::Matrix3d& matrix() const { return M_; }
  /// dM = skew(axes_v() d(pitch, heading)) M.
  const Eigen::Matrix<double, 3, 2>& axes_v() const { return axes_v_; }
  /// Of M w by (pitch, heading).
  Eigen::Matrix<double, 3, 2> gradient(const Eigen::Vector3d& told_w) const;

 private:
  Eigen::Matrix3d M_ = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 2> axes_v_;
};

}  // namespace foucault::state
