#include "foucault/fgo/chain.h"

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace foucault::fgo {
namespace {

using Eigen::Dynamic;
using Eigen::Index;

/// Reflects `length` rows from the diagonal of column k down so that nothing is left below it.
template <int kLength, class Rows>
void reflect_column(Rows& rows, Index k, Index length) {
  constexpr int kMostLength = kLength == Dynamic ? state::kMostSize + 1 : kLength;
  Eigen::Matrix<double, kLength, 1, Eigen::ColMajor, kMostLength, 1> v =
      rows.col(k).template segment<kLength>(k, length);
  const double norm = std::copysign(v.norm(), v[0]);
  if (norm == 0) return;
  rows.col(k).template segment<kLength>(k, length).setZero();
  rows(k, k) = -norm;
  v[0] += norm;
  const double scale = 1 / (norm * v[0]);
  for (Index j = k + 1; j < rows.cols(); ++j) {
    auto column = rows.col(j).template segment<kLength>(k, length);
    column -= (scale * v.dot(column)) * v;
  }
}

/// Reflects `dense` rows over triangular ones below them into the upper triangle of the first
/// `pivots` columns: in column k there is something in rows k to k + dense alone. Small rows keep
/// their digits if the large ones stand above: measurements, over what is left of the past.
template <int kDense, class Rows>
void reflect(Rows& rows, Index dense, Index pivots) {
  constexpr int kLength = kDense == Dynamic ? Dynamic : kDense + 1;
  for (Index k = 0; k < pivots; ++k) reflect_column<kLength>(rows, k, dense + 1);
}

/// Reflects a node's rows into an upper triangle.
template <class Rows, std::size_t... k>
void reflect_node(Rows&& rows, std::index_sequence<k...> /*columns*/) {
  (reflect_column<state::kNodeSize - static_cast<int>(k)>(rows, k, state::kNodeSize - k), ...);
}

/// Takes r + J d to what is known of d.
template <int kDense, class Jacobian, class Residual>
void put_on_top(const Jacobian& J, const Residual& r, NodeInformation& information) {
  constexpr int kMostDense = kDense == Dynamic ? state::kMostSize : kDense;
  const Index size = information.r.size();
  Eigen::Matrix<double, Dynamic, Dynamic, Eigen::ColMajor, kMostDense + state::kMostSize,
                state::kMostSize + 1>
      rows(r.size() + size, size + 1);
  rows.topLeftCorner(r.size(), size) = J;
  rows.col(size).head(r.size()) = r;
  rows.bottomLeftCorner(size, size) = information.S;
  rows.col(size).tail(size) = information.r;
  reflect<kDense>(rows, r.size(), size);
  information.S = rows.topLeftCorner(size, size);
  information.r = rows.col(size).head(size);
}

/// A column that depends on those before it keeps nothing but rounding on the diagonal.
template <class Triangle>
void throw_if_undetermined(const Triangle& R) {
  constexpr double kRounding = 1e-15;
  for (Index i = 0; i < R.rows(); ++i) {
    if (!(std::abs(R(i, i)) > kRounding * R.col(i).norm()))
      throw std::runtime_error("a node's state is not determined");
  }
}

}  // namespace

NodeInformation::NodeInformation(Index slow)
    : S(state::StateMatrix::Zero(state::kNodeSize + slow, state::kNodeSize + slow)),
      r(state::StateVector::Zero(state::kNodeSize + slow)) {}

void NodeInformation::add(const StateRows& rows) { put_on_top<Dynamic>(rows.J, rows.r, *this); }

void NodeInformation::add(const ObservationRows& rows, double weight) {
  const double root = std::sqrt(weight);
  if (rows.r.size() == 3) {
    put_on_top<3>(root * rows.J, root * rows.r, *this);
  } else {
    put_on_top<Dynamic>(root * rows.J, root * rows.r, *this);
  }
}

void NodeInformation::move_border(const state::SlowVector& moved) {
  if (moved.size() > 0) r += S.rightCols(moved.size()) * moved;
}

state::StateVector NodeInformation::solution() const {
  throw_if_undetermined(S);
  return S.triangularView<Eigen::Upper>().solve(-r);
}

state::NodeVector Conditional::eliminated(const state::StateVector& next) const {
  return R.triangularView<Eigen::Upper>().solve(-a - A * next);
}

state::StateMatrix Conditional::covariance(const state::StateMatrix& next) const {
  const Index size = next.rows();
  const Index slow = size - state::kNodeSize;
  const auto R_upper = R.triangularView<Eigen::Upper>();
  const state::NodeByState F = -R_upper.solve(A);
  const state::NodeMatrix root = R_upper.solve(state::NodeMatrix::Identity());
  const state::NodeByState FP = F * next;
  state::StateMatrix P(size, size);
  P.bottomRightCorner(slow, slow) = next.bottomRightCorner(slow, slow);
  P.topRightCorner(state::kNodeSize, slow) = FP.rightCols(slow);
  P.bottomLeftCorner(slow, state::kNodeSize) = FP.rightCols(slow).transpose();
  const state::NodeMatrix node = root * root.transpose() + FP * F.transpose();
  state::node_part(P) = 0.5 * (node + node.transpose());
  return P;
}

Elimination eliminate(const NodeInformation& first, const IntervalRows& interval) {
  constexpr int kNode = state::kNodeSize;
  const Index slow = first.slow();
  const Index columns = 2 * kNode + slow;
  Eigen::Matrix<double, 2 * kNode, Dynamic, Eigen::ColMajor, 2 * kNode,
                kNode + state::kMostSize + 1>
      rows(2 * kNode, columns + 1);
  rows << interval.J_x0, interval.J_x1, interval.J_slow, interval.r,  //
      first.S.topLeftCorner<kNode, kNode>(), state::NodeMatrix::Zero(),
      first.S.topRightCorner(kNode, slow), first.r.head<kNode>();
  reflect<kNode>(rows, kNode, kNode);
  Elimination out;
  out.R = rows.topLeftCorner<kNode, kNode>();
  throw_if_undetermined(out.R);
  out.A = rows.template block<kNode, Dynamic>(0, kNode, kNode, kNode + slow);
  out.a = rows.col(columns).head<kNode>();
  // The interval's rows are as many as the node's: none of them is left for the border.
  reflect_node(rows.bottomRightCorner(kNode, kNode + slow + 1),
               std::make_index_sequence<kNode - 1>{});
  out.rest.S.resize(kNode + slow, kNode + slow);
  out.rest.S.topRows<kNode>() = rows.block(kNode, kNode, kNode, kNode + slow);
  out.rest.S.bottomLeftCorner(slow, kNode).setZero();
  out.rest.S.bottomRightCorner(slow, slow) = first.S.bottomRightCorner(slow, slow);
  out.rest.r.resize(kNode + slow);
  out.rest.r << rows.col(columns).tail<kNode>(), first.r.tail(slow);
  return out;
}

Dependence on_itself(Index slow) {
  return {state::NodeByState::Identity(state::kNodeSize, state::kNodeSize + slow)};
}

Dependence of_node_before(const Conditional& before, const Dependence& node) {
  const auto R = before.R.triangularView<Eigen::Upper>();
  const state::NodeByState f = -R.solve(before.A);
  const state::NodeMatrix f_node = f.leftCols<state::kNodeSize>();
  const state::NodeMatrix root = R.solve(state::NodeMatrix::Identity());
  const Index slow = f.cols() - state::kNodeSize;
  Dependence out{f_node * node.F, root * root.transpose() + f_node * node.Q * f_node.transpose()};
  out.F.rightCols(slow) += f.rightCols(slow);
  return out;
}

state::StateMatrix covariance(const Dependence& node, const state::StateMatrix& later) {
  const Index slow = later.rows() - state::kNodeSize;
  const state::NodeByState FP = node.F * later;
  state::StateMatrix P = later;
  const state::NodeMatrix own = node.Q + FP * node.F.transpose();
  state::node_part(P) = 0.5 * (own + own.transpose());
  P.topRightCorner(state::kNodeSize, slow) = FP.rightCols(slow);
  P.bottomLeftCorner(slow, state::kNodeSize) = FP.rightCols(slow).transpose();
  return P;
}

state::StateVector joined(const state::NodeVector& node, const state::SlowVector& border) {
  state::StateVector out(node.size() + border.size());
  out << node, border;
  return out;
}

SquareRootPrior to_prior(const NodeInformation& information, const state::NodeState& at,
                         const state::SlowVector& slow) {
  return {at, slow, information.S, information.r};
}

state::StateMatrix covariance(const NodeInformation& information) {
  throw_if_undetermined(information.S);
  const Index size = information.r.size();
  state::StateMatrix root = state::StateMatrix::Identity(size, size);
  information.S.triangularView<Eigen::Upper>().solveInPlace(root);
  return root * root.transpose();
}

}  // namespace foucault::fgo
