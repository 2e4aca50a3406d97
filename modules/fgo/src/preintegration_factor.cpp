#include "foucault/fgo/preintegration_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace foucault {
namespace {

Matrix15d inverse_cholesky(const Matrix15d& covariance) {
  const Eigen::LLT<Matrix15d> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("preintegration covariance is not positive definite");
  Matrix15d inverse = Matrix15d::Identity();
  llt.matrixL().solveInPlace(inverse);
  return inverse;
}

void write_jacobian(const Matrix15d& tangent, const double* block, double* out) {
  Eigen::Map<Eigen::Matrix<double, 15, 16, Eigen::RowMajor>>{out} =
      ambient_jacobian<15>(tangent, block);
}

}  // namespace

PreintegrationFactor::PreintegrationFactor(const Preintegration& pre, const EarthModel& earth)
    : pre_(pre), earth_(earth), sqrt_information_(inverse_cholesky(pre.covariance)) {}

MotionResidual PreintegrationFactor::linearize(const NodeState& x0, const NodeState& x1) const {
  const MotionResidual m = motion_residual(x0, x1, pre_, earth_);
  MotionResidual out;
  out.r.noalias() = sqrt_information_.triangularView<Eigen::Lower>() * m.r;
  out.J_x0.noalias() = sqrt_information_.triangularView<Eigen::Lower>() * m.J_x0;
  out.J_x1.noalias() = sqrt_information_.triangularView<Eigen::Lower>() * m.J_x1;
  return out;
}

bool PreintegrationFactor::Evaluate(double const* const* blocks, double* residual,
                                    double** jacobians) const {
  const NodeState x0 = read_block(blocks[0]);
  const NodeState x1 = read_block(blocks[1]);
  if (jacobians == nullptr) {
    Eigen::Map<Vector15d>{residual} = sqrt_information_.triangularView<Eigen::Lower>() *
                                      motion_residual_value(x0, x1, pre_, earth_);
    return true;
  }
  const MotionResidual m = linearize(x0, x1);
  Eigen::Map<Vector15d>{residual} = m.r;
  if (jacobians[0] != nullptr) write_jacobian(m.J_x0, blocks[0], jacobians[0]);
  if (jacobians[1] != nullptr) write_jacobian(m.J_x1, blocks[1], jacobians[1]);
  return true;
}

}  // namespace foucault
