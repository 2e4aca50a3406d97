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
  const Vector15d last = -info.S.colPivHouseholderQr().solve(info.r);
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

TEST_F(Chain, InformationAddsUp) {
  NodeInformation info;
  info.add(first_);
  GnssFactor::Linearized fix;
  fix.r = random_vector(rng_).head<3>();
  fix.J = random_matrix(rng_).topRows<3>();
  constexpr double kWeight = 0.3;
  info.add(fix, kWeight);
  const Matrix15d H = first_.J.transpose() * first_.J + kWeight * fix.J.transpose() * fix.J;
  const Vector15d b = first_.J.transpose() * first_.r + kWeight * fix.J.transpose() * fix.r;
  EXPECT_LT((info.S.transpose() * info.S - H).norm(), 1e-12 * H.norm());
  EXPECT_LT((info.S.transpose() * info.r - b).norm(), 1e-12 * b.norm());
}

/// An hour of steps known to 0.1 mm, from a place known to 1000 km: 1e-20 of the intervals'
/// information, which no normal equation holds. Then a fix of 1 cm.
TEST(ChainOfAnOutage, KeepsWhatLittleIsKnown) {
  MotionResidual step;
  step.r.setZero();
  step.J_x1 = 1e4 * Matrix15d::Identity();
  step.J_x0 = -step.J_x1;
  NodeInformation info;
  info.S = 1e-6 * Matrix15d::Identity();
  constexpr int kSteps = 3600;
  for (int i = 0; i < kSteps; ++i) info = eliminate(info, step).rest;
  const Vector15d variance = covariance(info).diagonal();
  EXPECT_LT((variance.array() / (1e12 + kSteps * 1e-8) - 1).abs().maxCoeff(), 1e-9);
  GnssFactor::Linearized fix;
  fix.r.setZero();
  fix.J = 100 * Eigen::Matrix<double, 3, 15>::Identity();
  info.add(fix);
  const Vector15d after = covariance(info).diagonal();
  EXPECT_LT((after.head<3>().array() / 1e-4 - 1).abs().maxCoeff(), 1e-9);
  EXPECT_LT((after.tail<12>() - variance.tail<12>()).norm(), 1e-9 * variance.norm());
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
