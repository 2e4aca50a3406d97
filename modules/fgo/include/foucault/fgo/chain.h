#pragma once

#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/whitened_rows.h"

/// The graph is a chain: prior - node - interval - node - ..., with a border, the slow blocks, that
/// every node and interval may have to do with. Eliminating it from the old end, one node at a
/// time, gives both what marginalization keeps and the covariance of the newest node and the
/// border, at a cost linear in the nodes and without inverting the window.
///
/// Everything stays a square root, by Householder's QR. Normal equations would have to find what is
/// known of a node as a difference of squares: an interval of a second knows a step to 0.1 mm, an
/// outage of half an hour leaves a position to kilometres, and (1e-4 / 1e4)^2 is below rounding.
namespace foucault::fgo {

/// Rows that say something of a node's tangent and the border's, d: cost |r + S d|^2 / 2.
struct NodeInformation {
  state::StateMatrix S;  ///< upper triangular
  state::StateVector r;

  explicit NodeInformation(Eigen::Index slow = 0);

  Eigen::Index slow() const { return r.size() - state::kNodeSize; }

  void add(const StateRows& rows);
  /// `weight` scales the squared cost, as a robust loss does.
  void add(const ObservationRows& rows, double weight = 1);

  /// From now on the border's tangent is counted from a point that is `moved` further.
  void move_border(const state::SlowVector& moved);

  /// The d of least cost.
  state::StateVector solution() const;
};

/// What an eliminated node is for any value of the next node and the border:
/// its rows are a + R d + A (d_next, d_border).
struct Conditional {
  state::NodeMatrix R;  ///< upper triangular
  state::NodeByState A;
  state::NodeVector a;

  /// Tangent of the eliminated node that minimizes the cost, for that of the next and the border.
  state::NodeVector eliminated(const state::StateVector& next) const;

  /// Covariance of the eliminated node and the border, from that of the next node and the border.
  /// A sum of positive terms alone.
  state::StateMatrix covariance(const state::StateMatrix& next) const;
};

/// A node eliminated from the chain, and what it leaves on the next and the border.
struct Elimination : Conditional {
  NodeInformation rest;
};

/// Throws std::runtime_error if the eliminated node is not determined.
Elimination eliminate(const NodeInformation& first, const IntervalRows& interval);

/// How a node depends on a later one and the border: it is F (later, border) + e, with the
/// covariance Q of e.
struct Dependence {
  state::NodeByState F;
  state::NodeMatrix Q = state::NodeMatrix::Zero();
};

/// Of a node on itself.
Dependence on_itself(Eigen::Index slow);

/// Of the node before, which was eliminated, if `node` is the dependence of the next.
Dependence of_node_before(const Conditional& before, const Dependence& node);

/// Covariance of the node and the border, from that of the later one and the border.
state::StateMatrix covariance(const Dependence& node, const state::StateMatrix& later);

/// Tangents of a node and the border.
state::StateVector joined(const state::NodeVector& node, const state::SlowVector& border);

/// At the linearization point (at, slow).
SquareRootPrior to_prior(const NodeInformation& information, const state::NodeState& at,
                         const state::SlowVector& slow);

/// Of the node and the border.
/// Throws std::runtime_error if they are not determined.
state::StateMatrix covariance(const NodeInformation& information);

}  // namespace foucault::fgo
