#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "foucault/core/state.h"
#include "foucault/preintegration/earth.h"
#include "foucault/preintegration/preintegrator.h"

namespace foucault {

/// State of a node of the graph, paper (47), in w.
struct NodeState {
  Eigen::Vector3d p_w_b = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d v_w_b = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Quaterniond q_w_b = Eigen::Quaterniond::Identity();
  ImuBias bias;
};

/// x (+) d and y (-) x in the order of error_state, attitude on the right: (x (+) d) (-) x = d.
NodeState boxplus(const NodeState& x, const Vector15d& d);
Vector15d boxminus(const NodeState& y, const NodeState& x);

/// Residual (49) of an interval from x0 to x1 and its Jacobians by the tangents of both.
/// Rows: position [m], velocity [m/s], attitude [rad] in b(t_{k-1}) resp. b(t_k), bias changes.
///
/// With T the interval, w the Earth rate, R0 the attitude at t_{k-1}, a = R0^T w and dv, dp, idp
/// the preintegration at the node's bias:
///   r_p = R0^T (p1 - p0 - v0 T - g T^2/2 + 2 w x c) - (dp - a x (T dp - 2 idp))         (28)
///   r_v = R0^T (v1 - v0 - g T + 2 w x (p1 - p0))    - (dv - a x (T dv - dp))            (25)
///   r_q = log(dq^-1 (exp(-w T) q0)^-1 q1)                                              (22)
///   c   = v0 T^2/2 + g T^3/6 + R0 idp, the integral of p(t) - p0                       (29)
/// and, where gravity has a gradient G, g at p0 and G v0 T^2/2, G v0 T^3/6 added to what it does.
/// All rows are true minus measured, as the errors of the preintegration are: (49) as printed has
/// the opposite sign in its attitude row, which would turn its correlations with the others.
/// The Jacobians are exact derivatives of these expressions.
struct MotionResidual {
  Vector15d r;
  Matrix15d J_x0;
  Matrix15d J_x1;
};
MotionResidual motion_residual(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                               const EarthModel& earth);

/// The residual alone.
Vector15d motion_residual_value(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                                const EarthModel& earth);

/// The x1 that makes the residual zero.
NodeState predict(const NodeState& x0, const Preintegration& pre, const EarthModel& earth);

/// Covariance of predict(x0) for a covariance of x0, both in the tangent order of error_state.
Matrix15d predict_covariance(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                             const EarthModel& earth, const Matrix15d& covariance_x0);

}  // namespace foucault
