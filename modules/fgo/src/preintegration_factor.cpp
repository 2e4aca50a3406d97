#include "foucault/fgo/preintegration_factor.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <stdexcept>

#include "packed_triangle.h"

namespace foucault {
namespace {

struct WithCovariance : PreintegratedMotion {
  NodeMatrix covariance;
};
static_assert(sizeof(WithCovariance) == sizeof(Preintegration),
              "PreintegratedMotion and copy_motion have all members of Preintegration");

template <class From, class To>
void copy_motion(const From& from, To& to) {
  to.t_begin_ns = from.t_begin_ns;
  to.t_end_ns = from.t_end_ns;
  to.dt = from.dt;
  to.dq = from.dq;
  to.dv = from.dv;
  to.dp = from.dp;
  to.idp = from.idp;
  to.iidp = from.iidp;
  to.bias = from.bias;
  to.gyro_bias_decay = from.gyro_bias_decay;
  to.accel_bias_decay = from.accel_bias_decay;
  to.J_dp_bg = from.J_dp_bg;
  to.J_dp_ba = from.J_dp_ba;
  to.J_dv_bg = from.J_dv_bg;
  to.J_dv_ba = from.J_dv_ba;
  to.J_dq_bg = from.J_dq_bg;
}

NodeMatrix inverse_cholesky(const NodeMatrix& covariance) {
  const Eigen::LLT<NodeMatrix> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("preintegration covariance is not positive definite");
  NodeMatrix inverse = NodeMatrix::Identity();
  llt.matrixL().solveInPlace(inverse);
  return inverse;
}

/// Columns of the border. Only scale factors of the IMU act on an interval.
NodeBySlow slow_columns(const MotionResidual& /*m*/, int slow_size) {
  return NodeBySlow::Zero(kNodeSize, slow_size);
}

}  // namespace

PreintegrationFactor::PreintegrationFactor(const Preintegration& pre, const EarthModel& earth,
                                           const Layout& layout)
    : earth_(earth), slow_size_(layout.slow_size()) {
  copy_motion(pre, motion_);
  pack_lower(inverse_cholesky(pre.covariance), sqrt_information_.data());
  set_num_residuals(kNodeSize);
  *mutable_parameter_block_sizes() = block_sizes(2, slow_size_);
}

NodeMatrix PreintegrationFactor::sqrt_information() const {
  NodeMatrix root = NodeMatrix::Zero();
  unpack_lower(sqrt_information_.data(), root);
  return root;
}

Preintegration PreintegrationFactor::preintegration() const {
  Preintegration pre;
  copy_motion(motion_, pre);
  const NodeMatrix root =
      sqrt_information().triangularView<Eigen::Lower>().solve(NodeMatrix::Identity());
  pre.covariance = root * root.transpose();
  return pre;
}

IntervalRows PreintegrationFactor::linearize(const NodeState& x0, const NodeState& x1,
                                             const SlowVector& /*slow*/) const {
  Preintegration pre;
  copy_motion(motion_, pre);
  const MotionResidual m = motion_residual(x0, x1, pre, earth_);
  const NodeMatrix root = sqrt_information();
  const auto whiten = root.triangularView<Eigen::Lower>();
  IntervalRows out;
  out.r.noalias() = whiten * m.r;
  out.J_x0.noalias() = whiten * m.J_x0;
  out.J_x1.noalias() = whiten * m.J_x1;
  out.J_slow = slow_columns(m, slow_size_);
  if (slow_size_ > 0) out.J_slow = whiten * out.J_slow;
  return out;
}

NodeVector PreintegrationFactor::residual(const NodeState& x0, const NodeState& x1,
                                          const SlowVector& /*slow*/) const {
  Preintegration pre;
  copy_motion(motion_, pre);
  return sqrt_information().triangularView<Eigen::Lower>() *
         motion_residual_value(x0, x1, pre, earth_);
}

bool PreintegrationFactor::Evaluate(double const* const* blocks, double* residual,
                                    double** jacobians) const {
  const NodeState x0 = read_block(blocks[0]);
  const NodeState x1 = read_block(blocks[1]);
  const SlowVector slow = read_border(*this, blocks, 2);
  if (jacobians == nullptr) {
    Eigen::Map<NodeVector>{residual} = this->residual(x0, x1, slow);
    return true;
  }
  const IntervalRows rows = linearize(x0, x1, slow);
  Eigen::Map<NodeVector>{residual} = rows.r;
  if (jacobians[0] != nullptr) write_node_jacobian(rows.J_x0, blocks[0], jacobians[0]);
  if (jacobians[1] != nullptr) write_node_jacobian(rows.J_x1, blocks[1], jacobians[1]);
  if (slow_size_ > 0 && jacobians[2] != nullptr) write_border_jacobian(rows.J_slow, jacobians[2]);
  return true;
}

StateMatrix predict_covariance(const NodeState& x0, const NodeState& x1, const SlowVector& /*slow*/,
                               const Preintegration& pre, const EarthModel& earth,
                               const Layout& layout, const StateMatrix& covariance) {
  // r(x0, x1, border) = e: J1 d1 = e - J0 d0 - Js ds. J1 is block lower triangular with invertible
  // blocks.
  const MotionResidual m = motion_residual(x0, x1, pre, earth);
  const Eigen::PartialPivLU<NodeMatrix> J1(m.J_x1);
  StateMatrix F = StateMatrix::Identity(layout.size(), layout.size());
  node_part(F) = -J1.solve(m.J_x0);
  F.topRightCorner(kNodeSize, layout.slow_size()) = -J1.solve(slow_columns(m, layout.slow_size()));
  const NodeMatrix B = J1.solve(NodeMatrix::Identity());
  StateMatrix P = F * covariance * F.transpose();
  node_part(P) += B * pre.covariance * B.transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace foucault
