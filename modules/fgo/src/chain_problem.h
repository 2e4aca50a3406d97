#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <deque>
#include <memory>

#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/state_block.h"

namespace foucault {

/// Null for plain least squares.
std::unique_ptr<ceres::LossFunction> make_loss(const FgoOptions& options);

/// rho'(s): a robust loss as a weight on the squared residual at the solution; 1 without a loss.
double loss_weight(const ceres::LossFunction* loss, const GnssFactor::Linearized& fix);

/// The cost (48) over a chain of nodes, for Ceres. The factors are the caller's and outlive it.
class ChainProblem {
 public:
  /// A chain of one node.
  ChainProblem(const NodeState& first, PriorFactor& prior, ceres::LossFunction* loss);

  /// The next node, joined to the last.
  void add_node(const NodeState& x, PreintegrationFactor& interval);

  /// A fix at the last node.
  void add_fix(GnssFactor& fix);

  /// Solves from the states that the nodes have.
  /// Throws std::runtime_error if that fails.
  void optimize(const FgoOptions& options);

  NodeState state(std::size_t k) const { return read_block(blocks_[k].data()); }
  std::size_t size() const { return blocks_.size(); }

 private:
  double* add_block(const NodeState& x);

  ceres::LossFunction* loss_;
  StateManifold manifold_;
  std::deque<StateBlock> blocks_;
  ceres::Problem problem_;  ///< last: refers to the members above
};

}  // namespace foucault
