#include "foucault/fgo/chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

namespace foucault {
namespace {

Matrix15d random_matrix(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  Matrix15d M;
  for (double& m : M.reshaped()) m = normal(rng);
  return M;
}

Vector15d random_vector(std::mt19937& rng) { return random_matrix(rng).col(0); }

/// A chain of four nodes, as a dense least-squares problem and by elimination.
class Chain : public ::testing::Test {
 protected:
  static constexpr int kNodes = 4;

  Chain() {
    first_ = {random_vector(rng_), random_matrix(rng_)};
    for (int i = 0; i + 1 < kNodes; ++i)
      intervals_.push_back({random_vector(rng_), random_matrix(rng_), random_matrix(rng_)});
    const int rows = 15 * kNodes;
    J_ = Eigen::MatrixXd::Zero(rows, 15 * kNodes);
    r_ = Eigen::VectorXd::Zero(rows);
    J_.block<15, 15>(0, 0) = first_.J;
    r_.head<15>() = first_.r;
    for (int i = 0; i + 1 < kNodes; ++i) {
      J_.block<15, 15>(15 * (i + 1), 15 * i) = intervals_[i].J_x0;
      J_.block<15, 15>(15 * (i + 1), 15 * (i + 1)) = intervals_[i].J_x1;
      r_.segment<15>(15 * (i + 1)) = intervals_[i].r;
    }
  }

  NodeInformation eliminated() const {
    NodeInformation info;
    info.add(first_);
    for (const MotionResidual& interval : intervals_) info = eliminate(info, interval).rest;
    return info;
  }

  std::mt19937 rng_{5};
  PriorFactor::Linearized first_;
  std::vector<MotionResidual> intervals_;
  Eigen::MatrixXd J_;
  Eigen::VectorXd r_;
};

TEST_F(Chain, CovarianceOfTheLastNodeIsTheDenseOne) {
  const Eigen::MatrixXd P = (J_.transpose() * J_).inverse();
  const Matrix15d expected = P.bottomRightCorner<15, 15>();
  EXPECT_LT((covariance(eliminated()) - expected).norm(), 1e-8 * expected.norm());
}

TEST_F(Chain, SolutionOfTheLastNodeIsTheDenseOne) {
  const Eigen::VectorXd d = -J_.colPivHouseholderQr().solve(r_);
  const NodeInformation info = eliminated();
  const Vector15d last = -info.H.ldlt().solve(info.b);
  EXPECT_LT((last - d.tail<15>()).norm(), 1e-8 * d.norm());
}

TEST_F(Chain, EliminatedNodesFollowTheLast) {
  const Eigen::VectorXd dense = -J_.colPivHouseholderQr().solve(r_);
  std::vector<Elimination> steps;
  NodeInformation info;
  info.add(first_);
  for (const MotionResidual& interval : intervals_) {
    steps.push_back(eliminate(info, interval));
    info = steps.back().rest;
  }
  Vector15d d = dense.tail<15>();
  for (int k = kNodes - 1; k-- > 0;) {
    d = steps[k].eliminated(d);
    EXPECT_LT((d - dense.segment<15>(15 * k)).norm(), 1e-8 * dense.norm()) << "node " << k;
  }
}

TEST_F(Chain, SquareRootPriorHoldsTheSameInformation) {
  const NodeInformation info = eliminated();
  const SquareRootPrior prior = to_prior(info, NodeState{});
  EXPECT_LT((prior.S.transpose() * prior.S - info.H).norm(), 1e-12 * info.H.norm());
  EXPECT_LT((prior.S.transpose() * prior.r - info.b).norm(), 1e-10 * info.b.norm());
}

TEST_F(Chain, AnUndeterminedNodeIsAnError) {
  MotionResidual nothing;
  nothing.J_x0.setZero();
  nothing.J_x1.setZero();
  nothing.r.setZero();
  EXPECT_THROW(eliminate(NodeInformation{}, nothing), std::runtime_error);
}

}  // namespace
}  // namespace foucault
