#include "foucault/fgo/chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <vector>

namespace foucault::fgo {
namespace {

Eigen::MatrixXd random_matrix(std::mt19937& rng, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd M(rows, columns);
  for (double& m : M.reshaped()) m = normal(rng);
  return M;
}

/// A chain of four nodes and a border of so many rows, as a dense least-squares problem and by
/// elimination.
class Chain : public ::testing::TestWithParam<int> {
 protected:
  static constexpr int kNodes = 4;

  Chain() : J_(0, state::kNodeSize * kNodes + slow()), r_(0) {
    const Eigen::Index size = state::kNodeSize + slow();
    first_ = {random_matrix(rng_, size, 1), random_matrix(rng_, size, size)};
    add_rows(0, state::kNodeSize, first_.J, first_.r);
    for (int i = 0; i + 1 < kNodes; ++i) {
      intervals_.push_back({random_matrix(rng_, state::kNodeSize, 1),
                            random_matrix(rng_, state::kNodeSize, state::kNodeSize),
                            random_matrix(rng_, state::kNodeSize, state::kNodeSize),
                            random_matrix(rng_, state::kNodeSize, slow())});
      const IntervalRows& m = intervals_.back();
      Eigen::MatrixXd J(state::kNodeSize, 2 * state::kNodeSize + slow());
      J << m.J_x0, m.J_x1, m.J_slow;
      add_rows(state::kNodeSize * i, 2 * state::kNodeSize, J, m.r);
      observations_.push_back({random_matrix(rng_, 2, 1), random_matrix(rng_, 2, size)});
      add_rows(state::kNodeSize * (i + 1), state::kNodeSize, observations_[i].J,
               observations_[i].r);
    }
  }

  Eigen::Index slow() const { return GetParam(); }

  /// Rows over `own` columns from `at` on, and the border.
  void add_rows(Eigen::Index at, Eigen::Index own, const Eigen::MatrixXd& J,
                const Eigen::VectorXd& r) {
    const Eigen::Index row = r_.size();
    J_.conservativeResize(row + r.size(), Eigen::NoChange);
    J_.bottomRows(r.size()).setZero();
    J_.block(row, at, r.size(), own) = J.leftCols(own);
    J_.bottomRightCorner(r.size(), slow()) = J.rightCols(slow());
    r_.conservativeResize(row + r.size());
    r_.tail(r.size()) = r;
  }

  NodeInformation start() const {
    NodeInformation info(slow());
    info.add(first_);
    return info;
  }

  Elimination step(const NodeInformation& info, int i) const {
    Elimination elimination = eliminate(info, intervals_[i]);
    elimination.rest.add(observations_[i]);
    return elimination;
  }

  NodeInformation eliminated() const {
    NodeInformation info = start();
    for (int i = 0; i + 1 < kNodes; ++i) info = step(info, i).rest;
    return info;
  }

  Eigen::VectorXd dense_solution() const { return -J_.colPivHouseholderQr().solve(r_); }
  Eigen::MatrixXd dense_covariance() const { return (J_.transpose() * J_).inverse(); }

  std::mt19937 rng_{5};
  StateRows first_;
  std::vector<IntervalRows> intervals_;
  std::vector<ObservationRows> observations_;  ///< one a node but the first
  Eigen::MatrixXd J_;
  Eigen::VectorXd r_;
};
INSTANTIATE_TEST_SUITE_P(WithoutAndWithABorder, Chain,
                         ::testing::Values(0, 1, 6, state::kMostSlow));

TEST_P(Chain, CovarianceOfTheLastNodeAndTheBorderIsTheDenseOne) {
  const Eigen::Index size = state::kNodeSize + slow();
  const Eigen::MatrixXd expected = dense_covariance().bottomRightCorner(size, size);
  EXPECT_LT((covariance(eliminated()) - expected).norm(), 1e-8 * expected.norm());
}

TEST_P(Chain, SolutionOfTheLastNodeAndTheBorderIsTheDenseOne) {
  const Eigen::VectorXd d = dense_solution();
  EXPECT_LT((eliminated().solution() - d.tail(state::kNodeSize + slow())).norm(), 1e-8 * d.norm());
}

/// The solutions and covariances of the others, each with the border.
TEST_P(Chain, EliminatedNodesFollowTheLast) {
  const Eigen::VectorXd dense = dense_solution();
  const Eigen::MatrixXd dense_P = dense_covariance();
  std::vector<Elimination> steps;
  NodeInformation info = start();
  for (int i = 0; i + 1 < kNodes; ++i) {
    steps.push_back(step(info, i));
    info = steps.back().rest;
  }
  state::StateVector d = info.solution();
  state::StateMatrix P = covariance(info);
  for (int k = kNodes - 1; k-- > 0;) {
    d.head<state::kNodeSize>() = steps[k].eliminated(d);
    P = steps[k].covariance(P);
    EXPECT_LT(
        (d.head<state::kNodeSize>() - dense.segment<state::kNodeSize>(state::kNodeSize * k)).norm(),
        1e-8 * dense.norm())
        << "node " << k;
    Eigen::VectorXi rows(P.rows());
    rows << Eigen::VectorXi::LinSpaced(state::kNodeSize, state::kNodeSize * k,
                                       state::kNodeSize * (k + 1) - 1),
        Eigen::VectorXi::LinSpaced(slow(), state::kNodeSize * kNodes,
                                   state::kNodeSize * kNodes + GetParam() - 1);
    EXPECT_LT((P - dense_P(rows, rows)).norm(), 1e-8 * P.norm()) << "node " << k;
  }
}

TEST_P(Chain, InformationAddsUp) {
  NodeInformation info = start();
  for (const int rows : {1, 2, 3, 6}) {
    const NodeInformation before = info;
    const ObservationRows z{random_matrix(rng_, rows, 1),
                            random_matrix(rng_, rows, state::kNodeSize + slow())};
    constexpr double kWeight = 0.3;
    info.add(z, kWeight);
    const Eigen::MatrixXd H = before.S.transpose() * before.S + kWeight * z.J.transpose() * z.J;
    const Eigen::VectorXd b = before.S.transpose() * before.r + kWeight * z.J.transpose() * z.r;
    EXPECT_LT((info.S.transpose() * info.S - H).norm(), 1e-12 * H.norm());
    EXPECT_LT((info.S.transpose() * info.r - b).norm(), 1e-12 * b.norm());
  }
}

TEST_P(Chain, TheBorderMayBeCountedFromElsewhere) {
  NodeInformation info = eliminated();
  const state::StateVector before = info.solution();
  const state::SlowVector moved = random_matrix(rng_, slow(), 1);
  info.move_border(moved);
  const state::StateVector after = info.solution();
  EXPECT_LT((after.head<state::kNodeSize>() - before.head<state::kNodeSize>()).norm(),
            1e-9 * before.norm());
  EXPECT_LT((after.tail(slow()) + moved - before.tail(slow())).norm(), 1e-9 * before.norm());
}

/// An hour of steps known to 0.1 mm, from a place known to 1000 km: 1e-20 of the intervals'
/// information, which no normal equation holds. Then a fix of 1 cm.
TEST(ChainOfAnOutage, KeepsWhatLittleIsKnown) {
  IntervalRows step;
  step.r.setZero();
  step.J_slow = state::NodeBySlow(state::kNodeSize, 0);
  step.J_x1 = 1e4 * state::NodeMatrix::Identity();
  step.J_x0 = -step.J_x1;
  NodeInformation info;
  info.S = 1e-6 * state::NodeMatrix::Identity();
  constexpr int kSteps = 3600;
  for (int i = 0; i < kSteps; ++i) info = eliminate(info, step).rest;
  const state::NodeVector variance = covariance(info).diagonal();
  EXPECT_LT((variance.array() / (1e12 + kSteps * 1e-8) - 1).abs().maxCoeff(), 1e-9);
  const ObservationRows fix{Eigen::Vector3d::Zero(),
                            100 * Eigen::Matrix<double, 3, state::kNodeSize>::Identity()};
  info.add(fix);
  const state::NodeVector after = covariance(info).diagonal();
  EXPECT_LT((after.head<3>().array() / 1e-4 - 1).abs().maxCoeff(), 1e-9);
  EXPECT_LT((after.tail<12>() - variance.tail<12>()).norm(), 1e-9 * variance.norm());
}

TEST(ChainOfNothing, AnUndeterminedNodeIsAnError) {
  IntervalRows nothing;
  nothing.J_slow = state::NodeBySlow(state::kNodeSize, 0);
  nothing.J_x0.setZero();
  nothing.J_x1.setZero();
  nothing.r.setZero();
  EXPECT_THROW(eliminate(NodeInformation{}, nothing), std::runtime_error);
}

}  // namespace
}  // namespace foucault::fgo
