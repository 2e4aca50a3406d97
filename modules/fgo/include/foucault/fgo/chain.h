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

/// Information on the node behind the interval when the one before it is eliminated (Schur
/// complement). Throws std::runtime_error if the eliminated node is not determined.
NodeInformation eliminate(const NodeInformation& first, const MotionResidual& interval);

/// The square-root form at the linearization point `at`; H = S^T S, b = S^T r.
SquareRootPrior to_prior(const NodeInformation& information, const NodeState& at);

Matrix15d covariance(const NodeInformation& information);

}  // namespace foucault
