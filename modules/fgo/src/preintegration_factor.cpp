#include "foucault/fgo/preintegration_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "packed_triangle.h"

namespace foucault {
namespace {

struct Whole : PreintegratedMotion, ScaledMotion {
  NodeMatrix covariance;
};
static_assert(sizeof(Whole) == sizeof(Preintegration),
              "what is copied here are all members of Preintegration");

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
  to.by_gyro_bias = from.by_gyro_bias;
  to.by_accel_bias = from.by_accel_bias;
}

template <class From, class To>
void copy_scaled(const From& from, To& to) {
  to.scale = from.scale;
  to.by_gyro_scale = from.by_gyro_scale;
  to.by_accel_scale = from.by_accel_scale;
}

NodeMatrix inverse_cholesky(const NodeMatrix& covariance) {
  const Eigen::LLT<NodeMatrix> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("preintegration covariance is not positive definite");
  NodeMatrix inverse = NodeMatrix::Identity();
  llt.matrixL().solveInPlace(inverse);
  return inverse;
}

}  // namespace

PreintegrationFactor::PreintegrationFactor(const Preintegration& pre, const EarthModel& earth,
                                           const Layout& layout)
    : earth_(earth), layout_(layout) {
  copy_motion(pre, motion_);
  if (pre.scale) {
    scaled_ = std::make_unique<ScaledMotion>();
    copy_scaled(pre, *scaled_);
  }
  pack_lower(inverse_cholesky(pre.covariance), sqrt_information_.data());
  set_num_residuals(NodeVector::RowsAtCompileTime);
  *mutable_parameter_block_sizes() = block_sizes(2, layout.slow_size());
}

double PreintegrationFactor::turned_by(const ImuBias& bias, const SlowVector& slow) const {
  const double by_bias = (bias.gyro - motion_.bias.gyro).norm() * motion_.dt;
  if (!scaled_) return by_bias;
  const Eigen::Vector3d change = layout_.imu_scale(slow).gyro - scaled_->scale->gyro;
  return by_bias + change.cwiseProduct(so3::log(motion_.dq)).norm();
}

NodeMatrix PreintegrationFactor::sqrt_information() const {
  NodeMatrix root = NodeMatrix::Zero();
  unpack_lower(sqrt_information_.data(), root);
  return root;
}

Preintegration PreintegrationFactor::without_covariance() const {
  Preintegration pre;
  copy_motion(motion_, pre);
  if (scaled_) copy_scaled(*scaled_, pre);
  return pre;
}

Preintegration PreintegrationFactor::preintegration() const {
  Preintegration pre = without_covariance();
  const NodeMatrix root =
      sqrt_information().triangularView<Eigen::Lower>().solve(NodeMatrix::Identity());
  pre.covariance = root * root.transpose();
  return pre;
}

IntervalRows PreintegrationFactor::linearize(const NodeState& x0, const NodeState& x1,
                                             const SlowVector& slow) const {
  const MotionResidual m =
      motion_residual(x0, x1, without_covariance(), earth_, layout_.imu_scale(slow));
  const NodeMatrix root = sqrt_information();
  const auto whiten = root.triangularView<Eigen::Lower>();
  IntervalRows out;
  out.r.noalias() = whiten * m.r;
  out.J_x0.noalias() = whiten * m.J_x0;
  out.J_x1.noalias() = whiten * m.J_x1;
  out.J_slow = slow_jacobian(m, layout_);
  if (scaled_) out.J_slow = whiten * out.J_slow;
  return out;
}

NodeVector PreintegrationFactor::residual(const NodeState& x0, const NodeState& x1,
                                          const SlowVector& slow) const {
  return sqrt_information().triangularView<Eigen::Lower>() *
         motion_residual_value(x0, x1, without_covariance(), earth_, layout_.imu_scale(slow));
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
  if (slow.size() > 0 && jacobians[2] != nullptr) write_border_jacobian(rows.J_slow, jacobians[2]);
  return true;
}

}  // namespace foucault
