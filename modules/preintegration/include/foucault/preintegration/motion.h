#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "foucault/preintegration/earth.h"
#include "foucault/preintegration/preintegrator.h"
#include "foucault/state/layout.h"
#include "foucault/state/nav_state.h"

namespace foucault::preintegration {

/// Rows of a node by the axes of the IMU.
using NodeByAxis = state::NodeBy<3>;

/// Residual (49) of an interval from x0 to x1 and its Jacobians by the tangents of both, and by the
/// scale factors.
/// Rows: position [m], velocity [m/s], attitude [rad] in b_i(k-1) resp. b(t_k), bias changes.
///
/// Derivation. On the turning Earth p'' = C f + g(p) - 2 w x p', with g = g0 + G (p - p0). Seen
/// from axes that are fixed in inertial space and coincide with w at t_{k-1}, about p0, the way is
/// s(t) = Exp(w t) (p(t) - p0), and Coriolis is gone:
///     s'' = R0 a + Exp(w t) g0 + G' s,   G' = G + [w x]^2,
/// a being the specific force in b_i(k-1), whose integrals the preintegration is. In the last term,
/// 1.5e-6 / s^2 times the way, s is taken as v0 t + S2 g0 + R0 dp(t). So, with T the interval and
/// Sn the n-th integral of Exp(w t) over it,
///   s(T)  = Exp(w T) (p1 - p0),   s'(T) = Exp(w T) (v1 + w x (p1 - p0))
///   r_p = R0^T (s(T) - v0 T - S2 g0 - G' (v0 T^3/6 + S4 g0)) - R0^T G' R0 iidp - dp
///   r_v = R0^T (s'(T) - v0 - S1 g0 - G' (v0 T^2/2 + S3 g0)) - R0^T G' R0 idp - dv
///   r_q = log(dq^-1 q0^-1 Exp(w T) q1)                                                    (22)
///   r_b = b1 - b - decay (b0 - b),  b and decay those of the preintegration                (49)
/// To first order in w this is (25), (28) with (29). Exact in w T; what is left out is the turning
/// of G' with w and the change of G along the way: below 3 nm for 1 s at 250 m/s, 4 cm for 60 s.
/// All rows are true minus measured, as the errors of the preintegration are: (49) as printed has
/// the opposite sign in its attitude row, which would turn its correlations with the others.
/// dp, dv and dq are those at the biases b0 and at the scale factors, (46): with d the biases and
/// scale factors less those of the preintegration, J its Jacobians,
///   dp = pre.dp + sum J.dp d,   dv = pre.dv + sum J.dv d,   dq = pre.dq Exp(sum J.dq d)
/// The Jacobians are exact derivatives of these expressions; s is not corrected so.
struct MotionResidual {
  state::NodeVector r;
  state::NodeMatrix J_x0;
  state::NodeMatrix J_x1;
  /// Zero if the preintegration has no scale.
  NodeByAxis J_gyro_scale = NodeByAxis::Zero();
  NodeByAxis J_accel_scale = NodeByAxis::Zero();
  std::array<NodeByAxis, 2> J_gyro_cross{NodeByAxis::Zero(), NodeByAxis::Zero()};
  NodeByAxis J_accel_cross = NodeByAxis::Zero();
};
/// Here and below: `scale` counts if the preintegration has one.
MotionResidual motion_residual(const state::NodeState& x0, const state::NodeState& x1,
                               const MotionDeltas& pre, const EarthModel& earth,
                               const state::ImuScale& scale = {});

/// The residual alone.
state::NodeVector motion_residual_value(const state::NodeState& x0, const state::NodeState& x1,
                                        const MotionDeltas& pre, const EarthModel& earth,
                                        const state::ImuScale& scale = {});

/// Jacobian of the residual by the slow blocks; only the IMU's scale factors are in it.
state::NodeBySlow slow_jacobian(const MotionResidual& m, const state::Layout& layout);

/// The x1 that makes the residual zero.
state::NodeState predict(const state::NodeState& x0, const MotionDeltas& pre,
                         const EarthModel& earth, const state::ImuScale& scale = {});

/// Covariance of predict(x0) for a covariance of x0 and of slow blocks, constants of the values
/// `slow`. Precondition: where scale factors are among them the preintegration has a scale.
state::StateMatrix predict_covariance(const state::NodeState& x0, const state::NodeState& x1,
                                      const Preintegration& pre, const EarthModel& earth,
                                      const state::StateMatrix& covariance_x0,
                                      const state::Layout& layout = {},
                                      const state::SlowVector& slow = state::SlowVector(0));

}  // namespace foucault::preintegration
