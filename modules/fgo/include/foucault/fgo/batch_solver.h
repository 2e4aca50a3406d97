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

/// What is known of the border.
struct BorderEstimate {
  state::SlowVector value;
  state::SlowMatrix covariance;
};
BorderEstimate border_of(const BatchSolution& solution);

/// The solution if more is known of the border, `known` with all that the chain says of it: exact
/// where what more there is has to do with the nodes through the border alone.
void take_border(BatchSolution& solution, const BorderEstimate& known);

/// Minimizes the cost by Gauss and Newton from the nodes' first estimates, by damped steps where a
/// full one does not lower it. Intervals whose bias has moved are integrated again if their
/// increments were kept, and in `full` gravity is that of where the nodes come to lie.
/// Time and memory are linear in the nodes. Of the elimination every 64th node is kept; what is
/// between is eliminated again on the way back. The intervals are used up.
/// Throws std::runtime_error if the problem cannot be solved.
BatchSolution solve(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                    const imu::ImuNoise& noise);

/// The same of a chain that goes on, for its first nodes: those whose sigmas and states change by
/// less than a hundredth of a sigma, the border given, whatever comes after the chain. They are
/// taken off, with what they know left as the prior of the rest. None if nothing is settled.
///
/// Influence decays as information does: with the border given, elimination makes node k a linear
/// function of node k + 1, F(k) (node k + 1) + e(k). So the end of the chain, known to L L' without
/// anything after it, moves node k by W(k) = F(k) F(k + 1) ... L at one sigma, and no more than
/// W(k) W(k)' of its covariance can be taken away.
BatchSolution solve_settled(BatchChain& chain, const GraphContext& context,
                            const FgoOptions& options, const imu::ImuNoise& noise);

}  // namespace foucault::fgo
