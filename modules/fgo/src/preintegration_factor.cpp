#include "foucault/fgo/preintegration_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "packed_triangle.h"

namespace foucault::fgo {
namespace {

state::NodeMatrix inverse_cholesky(const state::NodeMatrix& covariance) {
  const Eigen::LLT<state::NodeMatrix> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("preintegration covariance is not positive definite");
  state::NodeMatrix inverse = state::NodeMatrix::Identity();
  llt.matrixL().solveInPlace(inverse);
  return inverse;
}

}  // namespace

PreintegrationFactor::PreintegrationFactor(const preintegration::Preintegration& pre,
                                           const preintegration::EarthModel& earth,
                                           const state::Layout& layout)
    : deltas_(pre), earth_(earth), layout_(layout) {
  pack_lower(inverse_cholesky(pre.covariance), sqrt_information_.data());
  set_num_residuals(state::NodeVector::RowsAtCompileTime);
  *mutable_parameter_block_sizes() = block_sizes(2, layout.slow_size());
}

double PreintegrationFactor::turned_by(const state::ImuBias& bias,
                                       const state::SlowVector& slow) const {
  const double by_bias = (bias.gyro - deltas_.bias.gyro).norm() * deltas_.dt;
  if (!deltas_.scale) return by_bias;
  const Eigen::Matrix3d change =
      layout_.imu_scale(slow).gyro_matrix() - deltas_.scale->gyro_matrix();
  return by_bias + (change * so3::log(deltas_.dq)).norm();
}

state::NodeMatrix PreintegrationFactor::sqrt_information() const {
  state::NodeMatrix root = state::NodeMatrix::Zero();
  unpack_lower(sqrt_information_.data(), root);
  return root;
}

preintegration::Preintegration PreintegrationFactor::preintegration() const {
  preintegration::Preintegration pre{deltas_, {}};
  const state::NodeMatrix root =
      sqrt_information().triangularView<Eigen::Lower>().solve(state::NodeMatrix::Identity());
  pre.covariance = root * root.transpose();
  return pre;
}

IntervalRows PreintegrationFactor::linearize(const state::NodeState& x0, const state::NodeState& x1,
                                             const state::SlowVector& slow) const {
  const preintegration::MotionResidual m =
      preintegration::motion_residual(x0, x1, deltas_, earth_, layout_.imu_scale(slow));
  const state::NodeMatrix root =
      sqrt_information();  // products of triangles of this size are slower
  IntervalRows out;
  out.r.noalias() = root * m.r;
  out.J_x0.noalias() = root.lazyProduct(m.J_x0);
  out.J_x1.noalias() = root.lazyProduct(m.J_x1);
  out.J_slow = preintegration::slow_jacobian(m, layout_);
  if (deltas_.scale) out.J_slow = root * out.J_slow;
  return out;
}

state::NodeVector PreintegrationFactor::residual(const state::NodeState& x0,
                                                 const state::NodeState& x1,
                                                 const state::SlowVector& slow) const {
  return sqrt_information().triangularView<Eigen::Lower>() *
         motion_residual_value(x0, x1, deltas_, earth_, layout_.imu_scale(slow));
}

bool PreintegrationFactor::Evaluate(double const* const* blocks, double* residual,
                                    double** jacobians) const {
  const state::NodeState x0 = read_block(blocks[0]);
  const state::NodeState x1 = read_block(blocks[1]);
  const state::SlowVector slow = read_border(*this, blocks, 2);
  if (jacobians == nullptr) {
    Eigen::Map<state::NodeVector>{residual} = this->residual(x0, x1, slow);
    return true;
  }
  const IntervalRows rows = linearize(x0, x1, slow);
  Eigen::Map<state::NodeVector>{residual} = rows.r;
  if (jacobians[0] != nullptr) write_node_jacobian(rows.J_x0, blocks[0], jacobians[0]);
  if (jacobians[1] != nullptr) write_node_jacobian(rows.J_x1, blocks[1], jacobians[1]);
  if (slow.size() > 0 && jacobians[2] != nullptr) write_border_jacobian(rows.J_slow, jacobians[2]);
  return true;
}

}  // namespace foucault::fgo
