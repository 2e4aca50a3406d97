#pragma once

#include <ceres/cost_function.h>

#include "foucault/fgo/state_block.h"
#include "foucault/fgo/whitened_rows.h"

namespace foucault::fgo {

/// Square-root prior on a node and the border: cost |r + S ((x, slow) (-) (at, slow_at))|^2 / 2.
/// What marginalization leaves, or an initial state with its covariance; {r_p, H_p} of (48).
struct SquareRootPrior {
  state::NodeState at;
  state::SlowVector slow_at;
  state::StateMatrix S = state::NodeMatrix::Identity();
  state::StateVector r = state::NodeVector::Zero();
};

/// Throws std::invalid_argument if the covariance is not positive definite.
SquareRootPrior prior_from_covariance(const state::NodeState& at, const state::SlowVector& slow_at,
                                      const state::StateMatrix& covariance);

/// Blocks: node, and border if there is one.
class PriorFactor final : public ceres::CostFunction {
 public:
  explicit PriorFactor(const SquareRootPrior& prior);

  StateRows linearize(const state::NodeState& x, const state::SlowVector& slow) const;

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  SquareRootPrior prior_;
};

}  // namespace foucault::fgo
