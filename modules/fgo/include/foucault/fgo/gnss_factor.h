#pragma once

#include <ceres/sized_cost_function.h>

#include "foucault/core/measurement.h"
#include "foucault/fgo/state_block.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault {

/// A GNSS position in w: what factor (50) needs of a fix.
struct LocalFix {
  Eigen::Vector3d p_w_a = Eigen::Vector3d::Zero();             ///< antenna [m]
  Eigen::Matrix3d covariance_w = Eigen::Matrix3d::Identity();  ///< [m^2]
  Eigen::Vector3d p_b_a = Eigen::Vector3d::Zero();             ///< lever arm in b [m]
};

/// The fix's NED covariance is turned to w at the fix's own place.
LocalFix to_local(const GnssFix& fix, const LocalFrame& frame);

/// Fix minus predicted antenna position, in w [m].
Eigen::Vector3d antenna_innovation(const NodeState& x, const LocalFix& fix);

/// d(p + R l) / d tangent, 3x15.
Eigen::Matrix<double, 3, 15> antenna_jacobian(const NodeState& x, const LocalFix& fix);

/// Residual (50), p + R l - fix, whitened.
class GnssFactor final : public ceres::SizedCostFunction<3, kStateBlockSize> {
 public:
  /// Throws std::invalid_argument if the covariance is not positive definite.
  explicit GnssFactor(const LocalFix& fix);

  struct Linearized {
    Eigen::Vector3d r;
    Eigen::Matrix<double, 3, 15> J;
  };
  /// Whitened residual and tangent Jacobian.
  Linearized linearize(const NodeState& x) const;

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  LocalFix fix_;
  Eigen::Matrix3d sqrt_information_;
};

}  // namespace foucault
