#pragma once

#include <deque>
#include <vector>

#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/imu_interval.h"
#include "foucault/fgo/observation_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/state/epoch.h"

/// The cost (48) over a whole log, minimized by eliminating its chain.
namespace foucault::fgo {

/// A chain of nodes, each joined to the next by an interval: nodes.size() == intervals.size() + 1.
struct BatchNode {
  int64_t t_ns = 0;
  state::NodeState x;  ///< first estimate
  std::vector<NodeObservation> observations;
};
struct BatchChain {
  SquareRootPrior prior;  ///< on the first node and the border, whose first estimate it has
  std::deque<BatchNode> nodes;
  std::deque<ImuInterval> intervals;
};

struct BatchSolution {
  std::vector<state::NodeState> x;
  state::SlowVector slow;
  /// Of each node and the border, from everything.
  std::vector<state::PackedSymmetric> covariance_w;
};

/// Minimizes the cost by Gauss and Newton from the nodes' first estimates, by damped steps where a
/// full one does not lower it. Intervals whose bias has moved are integrated again if their
/// increments were kept, and in `full` gravity is that of where the nodes come to lie.
/// Time and memory are linear in the nodes. Of the elimination every 64th node is kept; what is
/// between is eliminated again on the way back. The intervals are used up.
/// Throws std::runtime_error if the problem cannot be solved.
BatchSolution solve(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                    const imu::ImuNoise& noise);

}  // namespace foucault::fgo
