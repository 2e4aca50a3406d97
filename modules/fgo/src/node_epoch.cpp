#include "node_epoch.h"

namespace foucault::fgo {
namespace {

/// The part of a rotation that turns about the vertical.
Eigen::Quaterniond heading_part(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return Eigen::Quaterniond(q.w(), 0, 0, q.z()).normalized();
}

/// How a model's attitude turns with the frame.
Eigen::Quaterniond attitude_turn(const Eigen::Matrix3d& R,
                                 preintegration::PreintegrationModel model) {
  return model == preintegration::PreintegrationModel::full ? Eigen::Quaterniond(R)
                                                            : heading_part(R);
}

}  // namespace

state::StateMatrix turned(const state::StateMatrix& P, const Eigen::Matrix3d& R) {
  state::StateMatrix out = P;
  for (const state::NodeBlock& block : {state::block::position, state::block::velocity}) {
    state::rows_of(out, block) = (R * rows_of(out, block)).eval();
    state::columns_of(out, block) = (state::columns_of(out, block) * R.transpose()).eval();
  }
  return out;
}

LocalNode to_nav(const state::NodeState& x, const state::SlowVector& slow,
                 const GraphContext& context) {
  LocalNode local;
  local.x.position = context.frame.to_geodetic(x.p_w_b);
  local.R_n_w = context.frame.R_w_n(local.x.position).transpose();
  local.x.velocity_n = local.R_n_w * x.v_w_b;
  local.x.q_n_b = (attitude_turn(local.R_n_w, context.model) * x.q_w_b).normalized();
  local.x.bias = x.bias;
  local.x.slow = slow;
  return local;
}

state::NodeState to_node(const state::NavState& x, const GraphContext& context) {
  const Eigen::Matrix3d R_w_n = context.frame.R_w_n(x.position);
  state::NodeState node;
  node.p_w_b = context.frame.to_local(x.position);
  node.v_w_b = R_w_n * x.velocity_n;
  node.q_w_b = (attitude_turn(R_w_n, context.model) * x.q_n_b).normalized();
  node.bias = x.bias;
  return node;
}

state::Epoch to_epoch(int64_t t_ns, const state::NodeState& x, const state::SlowVector& slow,
                      const state::StateMatrix& covariance_w, const GraphContext& context) {
  const LocalNode local = to_nav(x, slow, context);
  state::Epoch epoch{local.x, turned(covariance_w, local.R_n_w)};
  epoch.t_ns = t_ns;
  return epoch;
}

}  // namespace foucault::fgo
