#pragma once

#include <ceres/sized_cost_function.h>

#include "foucault/fgo/state_block.h"

namespace foucault {

/// Residual (49) between two neighbouring nodes, whitened by the covariance (43).
/// Blocks: node k-1, node k. The square-root information is built once, here.
class PreintegrationFactor final
    : public ceres::SizedCostFunction<15, kStateBlockSize, kStateBlockSize> {
 public:
  /// Throws std::invalid_argument if the covariance is not positive definite.
  PreintegrationFactor(const Preintegration& pre, const EarthModel& earth);

  /// Whitened residual and tangent Jacobians.
  MotionResidual linearize(const NodeState& x0, const NodeState& x1) const;

  const Preintegration& preintegration() const { return pre_; }
  const EarthModel& earth() const { return earth_; }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  Preintegration pre_;
  EarthModel earth_;
  Matrix15d sqrt_information_;  ///< lower triangular, inverse Cholesky factor of the covariance
};

}  // namespace foucault
