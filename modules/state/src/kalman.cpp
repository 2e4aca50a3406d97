#include "foucault/state/kalman.h"

#include <Eigen/Cholesky>

#include "foucault/core/so3.h"

namespace foucault::state {

Innovation innovation_of(const Linearized& z, const StateMatrix& covariance) {
  const auto HP = (z.H * covariance).eval();
  Innovation innovation{z.r, z.R};
  innovation.covariance.noalias() += HP * z.H.transpose();
  return innovation;
}

template <int kMostRows>
void kalman_update(const LinearizedRows<kMostRows>& z, NavState& x, StateMatrix& P) {
  const StateByColumns<kMostRows> PHt = P * z.H.transpose();
  const auto S = (z.H * PHt + z.R).eval();
  const StateByColumns<kMostRows> K = S.llt().solve(PHt.transpose()).transpose();
  StateMatrix left = StateMatrix::Identity(P.rows(), P.cols());
  left.noalias() -= K * z.H;
  P = left * P * left.transpose() + K * z.R * K.transpose();

  const StateVector error = K * z.r;
  const Eigen::Matrix3d reset = so3::right_jacobian(part(error, block::attitude));
  rows_of(P, block::attitude) = (reset * rows_of(P, block::attitude)).eval();
  columns_of(P, block::attitude) = (columns_of(P, block::attitude) * reset.transpose()).eval();
  P = (0.5 * (P + P.transpose())).eval();
  x = boxplus(x, error);
}

template void kalman_update(const Linearized&, NavState&, StateMatrix&);
template void kalman_update(const LinearizedState&, NavState&, StateMatrix&);

}  // namespace foucault::state
