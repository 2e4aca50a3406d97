#pragma once

#include "foucault/fgo/graph_context.h"
#include "foucault/state/epoch.h"

/// Between a node's state in w and the local NED of its place.
namespace foucault::fgo {

/// Turns the position and velocity rows of a covariance from one local frame to another.
state::StateMatrix turned(const state::StateMatrix& P, const Eigen::Matrix3d& R);

/// A node's state in the local NED of its place; without its stamp.
/// A model whose gravity is constant in w levels its attitude by the accelerometers, which feel the
/// gravity of the place: what it calls the vertical of w is the local vertical. Its attitude is
/// turned by the convergence of the meridians alone, or the curvature would count twice.
struct LocalNode {
  state::NavState x;
  Eigen::Matrix3d R_n_w;
};
LocalNode to_nav(const state::NodeState& x, const state::SlowVector& slow,
                 const GraphContext& context);

state::NodeState to_node(const state::NavState& x, const GraphContext& context);

state::Epoch to_epoch(int64_t t_ns, const state::NodeState& x, const state::SlowVector& slow,
                      const state::StateMatrix& covariance_w, const GraphContext& context);

}  // namespace foucault::fgo
