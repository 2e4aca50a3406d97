#include "foucault/fgo/chain.h"

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

namespace foucault {
namespace {

constexpr int kNode = error_state::kSize;

/// Reflects `kDense` rows over kNode triangular ones into the upper triangle of the first kNode
/// columns: in column k there is something in rows k to k + kDense alone. Small rows keep their
/// digits if the large ones stand above: measurements, over what is left of the past.
template <int kDense, int kColumns>
void reflect(Eigen::Matrix<double, kDense + kNode, kColumns>& rows) {
  for (int k = 0; k < kNode; ++k) {
    Eigen::Matrix<double, kDense + 1, 1> v = rows.col(k).template segment<kDense + 1>(k);
    const double norm = std::copysign(v.norm(), v[0]);
    if (norm == 0) continue;
    rows.col(k).template segment<kDense + 1>(k).setZero();
    rows(k, k) = -norm;
    v[0] += norm;
    const double scale = 1 / (norm * v[0]);
    for (int j = k + 1; j < kColumns; ++j) {
      auto column = rows.col(j).template segment<kDense + 1>(k);
      column -= (scale * v.dot(column)) * v;
    }
  }
}

template <int kRows>
void put_on_top(const Eigen::Matrix<double, kRows, kNode>& J,
                const Eigen::Matrix<double, kRows, 1>& r, NodeInformation& information) {
  Eigen::Matrix<double, kRows + kNode, kNode + 1> rows;
  rows << J, r, information.S, information.r;
  reflect<kRows, kNode + 1>(rows);
  information.S = rows.template topLeftCorner<kNode, kNode>();
  information.r = rows.template topRightCorner<kNode, 1>();
}

/// A column that depends on those before it keeps nothing but rounding on the diagonal.
void throw_if_undetermined(const Matrix15d& R) {
  constexpr double kRounding = 1e-15;
  for (int i = 0; i < kNode; ++i) {
    if (!(std::abs(R(i, i)) > kRounding * R.col(i).norm()))
      throw std::runtime_error("a node's state is not determined");
  }
}

}  // namespace

void NodeInformation::add(const NodeInformation& other) {
  put_on_top<kNode>(other.S, other.r, *this);
}

void NodeInformation::add(const PriorFactor::Linearized& prior) {
  put_on_top<kNode>(prior.J, prior.r, *this);
}

void NodeInformation::add(const GnssFactor::Linearized& fix, double weight) {
  const double root = std::sqrt(weight);
  put_on_top<3>(root * fix.J, root * fix.r, *this);
}

Vector15d Elimination::eliminated(const Vector15d& next) const {
  return R.triangularView<Eigen::Upper>().solve(-a - A * next);
}

Elimination eliminate(const NodeInformation& first, const MotionResidual& interval) {
  Eigen::Matrix<double, 2 * kNode, 2 * kNode + 1> rows;
  rows << interval.J_x0, interval.J_x1, interval.r, first.S, Matrix15d::Zero(), first.r;
  reflect<kNode, 2 * kNode + 1>(rows);
  Elimination out;
  out.R = rows.topLeftCorner<kNode, kNode>();
  throw_if_undetermined(out.R);
  out.A = rows.block<kNode, kNode>(0, kNode);
  out.a = rows.topRightCorner<kNode, 1>();
  put_on_top<kNode>(rows.block<kNode, kNode>(kNode, kNode), rows.bottomRightCorner<kNode, 1>(),
                    out.rest);
  return out;
}

SquareRootPrior to_prior(const NodeInformation& information, const NodeState& at) {
  return {at, information.S, information.r};
}

Matrix15d covariance(const NodeInformation& information) {
  throw_if_undetermined(information.S);
  Matrix15d root = Matrix15d::Identity();
  information.S.triangularView<Eigen::Upper>().solveInPlace(root);
  return root * root.transpose();
}

}  // namespace foucault
