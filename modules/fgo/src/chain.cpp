#include "foucault/fgo/chain.h"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace foucault {
namespace {

Eigen::LLT<Matrix15d> factorize(const Matrix15d& H) {
  Eigen::LLT<Matrix15d> llt(H);
  if (llt.info() != Eigen::Success) throw std::runtime_error("a node's state is not determined");
  return llt;
}

}  // namespace

void NodeInformation::add(const PriorFactor::Linearized& prior) {
  H.noalias() += prior.J.transpose() * prior.J;
  b.noalias() += prior.J.transpose() * prior.r;
}

void NodeInformation::add(const GnssFactor::Linearized& fix, double weight) {
  H.noalias() += weight * fix.J.transpose() * fix.J;
  b.noalias() += weight * fix.J.transpose() * fix.r;
}

Vector15d Elimination::eliminated(const Vector15d& next) const {
  return L.triangularView<Eigen::Lower>().transpose().solve(-a - A * next);
}

Elimination eliminate(const NodeInformation& first, const MotionResidual& interval) {
  const Matrix15d H00 = first.H + interval.J_x0.transpose() * interval.J_x0;
  const Matrix15d H01 = interval.J_x0.transpose() * interval.J_x1;
  const Vector15d b0 = first.b + interval.J_x0.transpose() * interval.r;
  const Eigen::LLT<Matrix15d> llt = factorize(H00);
  Elimination out;
  out.L = llt.matrixL();
  out.A = llt.matrixL().solve(H01);
  out.a = llt.matrixL().solve(b0);
  // The complement is a difference of squares, symmetric by form.
  out.rest.H.noalias() = interval.J_x1.transpose() * interval.J_x1 - out.A.transpose() * out.A;
  out.rest.b.noalias() = interval.J_x1.transpose() * interval.r - out.A.transpose() * out.a;
  return out;
}

SquareRootPrior to_prior(const NodeInformation& information, const NodeState& at) {
  const Eigen::LLT<Matrix15d> llt = factorize(information.H);
  SquareRootPrior prior;
  prior.at = at;
  prior.S = llt.matrixU();
  prior.r = llt.matrixL().solve(information.b);
  return prior;
}

Matrix15d covariance(const NodeInformation& information) {
  const Matrix15d P = factorize(information.H).solve(Matrix15d::Identity());
  return 0.5 * (P + P.transpose());
}

}  // namespace foucault
