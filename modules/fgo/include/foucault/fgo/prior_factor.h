#pragma once

#include <ceres/sized_cost_function.h>

#include "foucault/fgo/state_block.h"

namespace foucault {

/// Square-root prior on a node: cost |r + S (x (-) at)|^2 / 2. What marginalization leaves, or an
/// initial state with its covariance; {r_p, H_p} of (48).
struct SquareRootPrior {
  NodeState at;
  Matrix15d S = Matrix15d::Identity();
  Vector15d r = Vector15d::Zero();
};

/// Throws std::invalid_argument if the covariance is not positive definite.
SquareRootPrior prior_from_covariance(const NodeState& at, const Matrix15d& covariance);

class PriorFactor final : public ceres::SizedCostFunction<15, kStateBlockSize> {
 public:
  explicit PriorFactor(const SquareRootPrior& prior) : prior_(prior) {}

  struct Linearized {
    Vector15d r;
    Matrix15d J;
  };
  Linearized linearize(const NodeState& x) const;

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  SquareRootPrior prior_;
};

}  // namespace foucault
