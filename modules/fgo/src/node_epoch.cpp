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

Matrix15d turned(const Matrix15d& P, const Eigen::Matrix3d& R) {
  Matrix15d T = Matrix15d::Identity();
  T.block<3, 3>(error_state::kPosition, error_state::kPosition) = R;
  T.block<3, 3>(error_state::kVelocity, error_state::kVelocity) = R;
  return T * P * T.transpose();
}

NodeState to_node(const Epoch& epoch, const LocalFrame& frame, PreintegrationModel model) {
  const Eigen::Matrix3d R_w_n = frame.R_w_n(epoch.position);
  NodeState x;
  x.p_w_b = frame.to_local(epoch.position);
  x.v_w_b = R_w_n * epoch.velocity_n;
  x.q_w_b = (attitude_turn(R_w_n, model) * epoch.q_n_b).normalized();
  x.bias = epoch.bias;
  return x;
}

Epoch to_epoch(int64_t t_ns, const NodeState& x, const Matrix15d& covariance_w,
               const LocalFrame& frame, PreintegrationModel model) {
  Epoch epoch;
  epoch.t_ns = t_ns;
  epoch.position = frame.to_geodetic(x.p_w_b);
  const Eigen::Matrix3d R_n_w = frame.R_w_n(epoch.position).transpose();
  epoch.velocity_n = R_n_w * x.v_w_b;
  epoch.q_n_b = (attitude_turn(R_n_w, model) * x.q_w_b).normalized();
  epoch.bias = x.bias;
  epoch.covariance = turned(covariance_w, R_n_w);
  return epoch;
}

}  // namespace foucault
