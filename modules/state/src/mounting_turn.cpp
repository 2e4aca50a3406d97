#include "foucault/state/mounting_turn.h"

#include "foucault/core/so3.h"

namespace foucault::state {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

MountingTurn::MountingTurn(const SlowVector& slow, const SlowBlock* mounting) {
  const double pitch = mounting ? slow[mounting->index] : 0;
  const double heading = mounting ? slow[mounting->index + 1] : 0;
  const Eigen::Matrix3d by_heading = AngleAxisd(heading, Vector3d::UnitZ()).toRotationMatrix();
  M_ = by_heading * AngleAxisd(pitch, Vector3d::UnitY());
  axes_v_ << by_heading.col(1), Vector3d::UnitZ();
}

Eigen::Matrix<double, 3, 2> MountingTurn::gradient(const Vector3d& told_w) const {
  return -so3::skew(M_ * told_w) * axes_v_;
}

}  // namespace foucault::state
