#pragma once

#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"

/// The graph is a chain: prior - node - interval - node - ... Eliminating it from the old end, one
/// 15x15 block at a time, gives both what marginalization keeps and the covariance of the newest
/// node, at a cost linear in the nodes and without inverting the window.
namespace foucault {

/// Quadratic in a node's tangent: d^T H d / 2 + b^T d.
struct NodeInformation {
  Matrix15d H = Matrix15d::Zero();
  Vector15d b = Vector15d::Zero();

  void add(const PriorFactor::Linearized& prior);
  /// `weight` scales the squared cost, as a robust loss does.
  void add(const GnssFactor::Linearized& fix, double weight = 1);
};

/// A node eliminated from the chain (Schur complement): what it leaves on the next, and its own
/// best value for any value of that one. With H00 = L L^T of the two nodes' normal equations, A =
/// L^-1 H01 and a = L^-1 b0.
struct Elimination {
  NodeInformation rest;
  Matrix15d L;  ///< lower triangular
  Matrix15d A;
  Vector15d a;

  /// Tangent of the eliminated node that minimizes the cost when the next one's is `next`.
  Vector15d eliminated(const Vector15d& next) const;
};

/// Throws std::runtime_error if the eliminated node is not determined.
Elimination eliminate(const NodeInformation& first, const MotionResidual& interval);

/// The square-root form at the linearization point `at`; H = S^T S, b = S^T r.
SquareRootPrior to_prior(const NodeInformation& information, const NodeState& at);

Matrix15d covariance(const NodeInformation& information);

}  // namespace foucault
