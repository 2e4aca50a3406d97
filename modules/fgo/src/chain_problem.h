#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstdint>
#include <deque>

#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/observation_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/state_block.h"

namespace foucault::fgo {

/// The cost (48) over a chain of nodes and a border, for Ceres. The factors are the caller's and
/// outlive it.
class ChainProblem {
 public:
  /// A chain of one node.
  ChainProblem(const state::NodeState& first, const state::SlowVector& slow, PriorFactor& prior,
               ceres::LossFunction* loss);

  /// The next node, joined to the last.
  void add_node(const state::NodeState& x, PreintegrationFactor& interval);

  /// An observation at the last node.
  void add(ObservationFactor& observation);

  /// Solves from the states that the nodes have; gives the number of iterations.
  /// Throws std::runtime_error if that fails.
  int64_t optimize(const FgoOptions& options);

  state::NodeState state(std::size_t k) const { return read_block(blocks_[k].data()); }
  const state::SlowVector& slow() const { return slow_; }
  std::size_t size() const { return blocks_.size(); }

 private:
  double* add_block(const state::NodeState& x);
  std::vector<double*> with_border(std::vector<double*> nodes);

  ceres::LossFunction* loss_;
  StateManifold manifold_;
  std::deque<StateBlock> blocks_;
  state::SlowVector slow_;
  ceres::Problem problem_;  ///< last: refers to the members above
};

}  // namespace foucault::fgo
