#include "node_epoch.h"

namespace foucault {
namespace {

/// The part of a rotation that turns about the vertical.
Eigen::Quaterniond heading_part(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return Eigen::Quaterniond(q.w(), 0, 0, q.z()).normalized();
}

/// How a model's attitude turns with the frame.
Eigen::Quaterniond attitude_turn(const Eigen::Matrix3d& R, PreintegrationModel model) {
  return model == PreintegrationModel::full ? Eigen::Quaterniond(R) : heading_part(R);
}

}  // namespace

StateMatrix turned(const StateMatrix& P, const Eigen::Matrix3d& R) {
  StateMatrix out = P;
  for (const NodeBlock& block : {block::position, block::velocity}) {
    rows_of(out, block) = (R * rows_of(out, block)).eval();
    columns_of(out, block) = (columns_of(out, block) * R.transpose()).eval();
  }
  return out;
}

LocalNode to_nav(const NodeState& x, const SlowVector& slow, const GraphContext& context) {
  LocalNode local;
  local.x.position = context.frame.to_geodetic(x.p_w_b);
  local.R_n_w = context.frame.R_w_n(local.x.position).transpose();
  local.x.velocity_n = local.R_n_w * x.v_w_b;
  local.x.q_n_b = (attitude_turn(local.R_n_w, context.model) * x.q_w_b).normalized();
  local.x.bias = x.bias;
  local.x.slow = slow;
  return local;
}

NodeState to_node(const Epoch& epoch, const GraphContext& context) {
  const Eigen::Matrix3d R_w_n = context.frame.R_w_n(epoch.position);
  NodeState x;
  x.p_w_b = context.frame.to_local(epoch.position);
  x.v_w_b = R_w_n * epoch.velocity_n;
  x.q_w_b = (attitude_turn(R_w_n, context.model) * epoch.q_n_b).normalized();
  x.bias = epoch.bias;
  return x;
}

StateMatrix covariance_w(const Epoch& epoch, const GraphContext& context) {
  const int slow = context.layout.slow_size();
  StateMatrix P = StateMatrix::Zero(kNodeSize + slow, kNodeSize + slow);
  node_part(P) = epoch.covariance;
  P.bottomRightCorner(slow, slow) = context.layout.prior();
  return turned(P, context.frame.R_w_n(epoch.position));
}

Epoch to_epoch(int64_t t_ns, const NodeState& x, const SlowVector& slow,
               const StateMatrix& covariance_w, const GraphContext& context) {
  const LocalNode local = to_nav(x, slow, context);
  Epoch epoch;
  epoch.t_ns = t_ns;
  epoch.position = local.x.position;
  epoch.velocity_n = local.x.velocity_n;
  epoch.q_n_b = local.x.q_n_b;
  epoch.bias = local.x.bias;
  epoch.covariance = node_part(turned(covariance_w, local.R_n_w));
  return epoch;
}

}  // namespace foucault
