#include "foucault/fgo/prior_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "foucault/core/so3.h"

namespace foucault {

SquareRootPrior prior_from_covariance(const NodeState& at, const Matrix15d& covariance) {
  const Eigen::LLT<Matrix15d> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("covariance of a prior is not positive definite");
  SquareRootPrior prior;
  prior.at = at;
  llt.matrixL().solveInPlace(prior.S);
  return prior;
}

PriorFactor::Linearized PriorFactor::linearize(const NodeState& x) const {
  const Vector15d d = boxminus(x, prior_.at);
  Matrix15d J = prior_.S;
  J.middleCols<3>(error_state::kAttitude) =
      prior_.S.middleCols<3>(error_state::kAttitude) *
      so3::right_jacobian_inverse(d.segment<3>(error_state::kAttitude));
  return {prior_.r + prior_.S * d, J};
}

bool PriorFactor::Evaluate(double const* const* blocks, double* residual,
                           double** jacobians) const {
  const Linearized prior = linearize(read_block(blocks[0]));
  Eigen::Map<Vector15d>{residual} = prior.r;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 15, 16, Eigen::RowMajor>>{jacobians[0]} =
        ambient_jacobian<15>(prior.J, blocks[0]);
  }
  return true;
}

}  // namespace foucault
