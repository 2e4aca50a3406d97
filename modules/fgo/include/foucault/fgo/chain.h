#pragma once

#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"

/// The graph is a chain: prior - node - interval - node - ... Eliminating it from the old end, one
/// node at a time, gives both what marginalization keeps and the covariance of the newest node, at
/// a cost linear in the nodes and without inverting the window.
///
/// Everything stays a square root, by Householder's QR. Normal equations would have to find what is
/// known of a node as a difference of squares: an interval of a second knows a step to 0.1 mm, an
/// outage of half an hour leaves a position to kilometres, and (1e-4 / 1e4)^2 is below rounding.
namespace foucault {

/// Rows that say something of a node's tangent d: cost |r + S d|^2 / 2.
struct NodeInformation {
  Matrix15d S = Matrix15d::Zero();  ///< upper triangular
  Vector15d r = Vector15d::Zero();

  void add(const NodeInformation& other);
  void add(const PriorFactor::Linearized& prior);
  /// `weight` scales the squared cost, as a robust loss does.
  void add(const GnssFactor::Linearized& fix, double weight = 1);
};

/// A node eliminated from the chain: what it leaves on the next, and its own best value for any
/// value of that one. Its rows are a + R d + A d_next.
struct Elimination {
  NodeInformation rest;
  Matrix15d R;  ///< upper triangular
  Matrix15d A;
  Vector15d a;

  /// Tangent of the eliminated node that minimizes the cost when the next one's is `next`.
  Vector15d eliminated(const Vector15d& next) const;
};

/// Throws std::runtime_error if the eliminated node is not determined.
Elimination eliminate(const NodeInformation& first, const MotionResidual& interval);

/// At the linearization point `at`.
SquareRootPrior to_prior(const NodeInformation& information, const NodeState& at);

/// Throws std::runtime_error if the node is not determined.
Matrix15d covariance(const NodeInformation& information);

}  // namespace foucault
