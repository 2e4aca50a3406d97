#pragma once

#include "foucault/core/so3.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/nav_state.h"

/// A GNSS position in w, Cartesian: another route to what an observation says in the local NED.
namespace foucault::testing {

struct CartesianFix {
  Eigen::Vector3d p_w_a;
  Eigen::Matrix3d covariance_w;
  Eigen::Vector3d p_b_a;
};

inline CartesianFix cartesian(const GnssFix& fix, const geodesy::LocalFrame& frame) {
  const Eigen::Matrix3d R_w_n = frame.R_w_n(fix.antenna);
  return {frame.to_local(fix.antenna), R_w_n * fix.position_covariance * R_w_n.transpose(),
          fix.p_b_a};
}

/// Fix minus predicted antenna position, in w [m].
inline Eigen::Vector3d antenna_innovation(const state::NodeState& x, const CartesianFix& fix) {
  return fix.p_w_a - (x.p_w_b + x.q_w_b * fix.p_b_a);
}

/// d(p + R l) / d tangent.
inline Eigen::Matrix<double, 3, state::kNodeSize> antenna_jacobian(const state::NodeState& x,
                                                                   const CartesianFix& fix) {
  Eigen::Matrix<double, 3, state::kNodeSize> J = Eigen::Matrix<double, 3, state::kNodeSize>::Zero();
  state::columns_of(J, state::block::position).setIdentity();
  state::columns_of(J, state::block::attitude) = -x.q_w_b.toRotationMatrix() * so3::skew(fix.p_b_a);
  return J;
}

}  // namespace foucault::testing
