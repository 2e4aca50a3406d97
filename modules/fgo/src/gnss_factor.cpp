#include "foucault/fgo/gnss_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "foucault/core/so3.h"

namespace foucault {

LocalFix to_local(const GnssFix& fix, const LocalFrame& frame) {
  const Eigen::Matrix3d R_w_n = frame.R_w_n(fix.antenna);
  return {frame.to_local(fix.antenna), R_w_n * fix.position_covariance * R_w_n.transpose(),
          fix.p_b_a};
}

Eigen::Vector3d antenna_innovation(const NodeState& x, const LocalFix& fix) {
  return fix.p_w_a - (x.p_w_b + x.q_w_b * fix.p_b_a);
}

Eigen::Matrix<double, 3, 15> antenna_jacobian(const NodeState& x, const LocalFix& fix) {
  Eigen::Matrix<double, 3, 15> J = Eigen::Matrix<double, 3, 15>::Zero();
  J.block<3, 3>(0, error_state::kPosition).setIdentity();
  J.block<3, 3>(0, error_state::kAttitude) = -x.q_w_b.toRotationMatrix() * so3::skew(fix.p_b_a);
  return J;
}

GnssFactor::GnssFactor(const LocalFix& fix) : fix_(fix) {
  const Eigen::LLT<Eigen::Matrix3d> llt(fix.covariance_w);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("covariance of a GNSS fix is not positive definite");
  sqrt_information_.setIdentity();
  llt.matrixL().solveInPlace(sqrt_information_);
}

GnssFactor::Linearized GnssFactor::linearize(const NodeState& x) const {
  return {-sqrt_information_ * antenna_innovation(x, fix_),
          sqrt_information_ * antenna_jacobian(x, fix_)};
}

bool GnssFactor::Evaluate(double const* const* blocks, double* residual, double** jacobians) const {
  const NodeState x = read_block(blocks[0]);
  Eigen::Map<Eigen::Vector3d>{residual} = -sqrt_information_ * antenna_innovation(x, fix_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 16, Eigen::RowMajor>>{jacobians[0]} =
        ambient_jacobian<3>(sqrt_information_ * antenna_jacobian(x, fix_), blocks[0]);
  }
  return true;
}

}  // namespace foucault
