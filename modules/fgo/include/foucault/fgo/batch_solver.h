#pragma once

#include <deque>
#include <vector>

#include "foucault/fgo/chain.h"
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

/// A node and the border.
struct NodeEstimate {
  state::NodeState x;
  state::SlowVector slow;
  state::StateMatrix covariance = state::NodeMatrix::Zero();
};

/// What the first node of a part of a chain has to do with what comes after the part: all of it
/// goes through the node behind the part and the border. Of the estimates from the part and a
/// little more, `first` and `behind`,
///   node - first = F ((node behind, border) - behind) + e,
/// `dependence` has F and the covariance of e, which has nothing to do with what is after the part.
struct PartLink {
  NodeEstimate first;   ///< its covariance: only at the end of a chain, where nothing comes behind
  NodeEstimate behind;  ///< without covariance
  Dependence dependence;
  bool ends_chain = false;
};

/// The estimate of the first node from one of the node behind, that knows everything.
NodeEstimate through(const PartLink& link, const NodeEstimate& behind);

/// For every part the node behind it, from everything; of those that end a chain there is none.
std::vector<NodeEstimate> nodes_behind(const std::vector<PartLink>& links);

/// Minimizes the cost by Gauss and Newton from the nodes' first estimates, by damped steps where a
/// full one does not lower it. Intervals whose bias has moved are integrated again if their
/// increments were kept, and in `full` gravity is that of where the nodes come to lie.
/// Time and memory are linear in the nodes. Of the elimination every 64th node is kept; what is
/// between is eliminated again on the way back. The intervals are used up.
/// Throws std::runtime_error if the problem cannot be solved.
BatchSolution solve(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                    const imu::ImuNoise& noise);

/// Three quarters of a chain that goes on, which are taken off, with what they know left as the
/// prior of the rest. The last quarter is there that their states are near enough to the final ones
/// for everything to be linear; with the node behind them known from everything, `behind`, they
/// come out as if the whole had been solved. Throws std::runtime_error as solve().
struct BatchPart {
  BatchSolution solution;
  PartLink link;
};
BatchPart solve_part(BatchChain& chain, const GraphContext& context, const FgoOptions& options,
                     const imu::ImuNoise& noise, const NodeEstimate* behind);

}  // namespace foucault::fgo
