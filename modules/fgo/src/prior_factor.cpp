#include "foucault/fgo/prior_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>

#include "foucault/core/so3.h"

namespace foucault::fgo {

SquareRootPrior prior_from_covariance(const state::NodeState& at, const state::SlowVector& slow_at,
                                      const state::StateMatrix& covariance) {
  const Eigen::LLT<state::StateMatrix> llt(covariance);
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("covariance of a prior is not positive definite");
  const Eigen::Index size = covariance.rows();
  SquareRootPrior prior{at, slow_at, state::StateMatrix::Identity(size, size),
                        state::StateVector::Zero(size)};
  llt.matrixL().solveInPlace(prior.S);
  return prior;
}

PriorFactor::PriorFactor(const SquareRootPrior& prior) : prior_(prior) {
  set_num_residuals(static_cast<int>(prior.r.size()));
  *mutable_parameter_block_sizes() = block_sizes(1, prior.slow_at.size());
}

StateRows PriorFactor::linearize(const state::NodeState& x, const state::SlowVector& slow) const {
  state::StateVector d(prior_.r.size());
  d << state::boxminus(x, prior_.at), slow - prior_.slow_at;
  StateRows rows{prior_.r + prior_.S * d, prior_.S};
  state::columns_of(rows.J, state::block::attitude) =
      state::columns_of(prior_.S, state::block::attitude) *
      so3::right_jacobian_inverse(state::part(d, state::block::attitude));
  return rows;
}

bool PriorFactor::Evaluate(double const* const* blocks, double* residual,
                           double** jacobians) const {
  const StateRows rows = linearize(read_block(blocks[0]), read_border(*this, blocks));
  write_rows(rows, blocks, residual, jacobians);
  return true;
}

}  // namespace foucault::fgo
