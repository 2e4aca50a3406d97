#include "foucault/state/kalman.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "random_state.h"

namespace foucault::state {
namespace {

using namespace testing;

/// An inverse of condition below 1e3 (covariances below 100, H some units) at double precision,
/// twice.
constexpr double kRounding = 1e-10;

struct Case {
  NavState x;
  StateMatrix P;
  Linearized z{kMostMeasured, kNodeSize};
};

Case random_case(unsigned seed, int slow_size, int rows = kMostMeasured) {
  std::mt19937 rng{seed};
  Case c;
  c.x = random_state(rng, slow_size);
  c.P = random_covariance(rng, state_size(slow_size));
  c.z = Linearized(rows, static_cast<int>(state_size(slow_size)));
  for (Eigen::Index i = 0; i < c.z.H.cols(); ++i) c.z.H.col(i) = draw(rng, rows);
  c.z.r = draw(rng, rows);
  c.z.R = random_covariance(rng, rows);
  return c;
}

/// The other route: P1^-1 = P^-1 + H' R^-1 H, error = P1 H' R^-1 r.
struct InformationForm {
  StateMatrix P;
  StateVector error;
};

InformationForm by_information(const Case& c) {
  const StateMatrix I = StateMatrix::Identity(c.P.rows(), c.P.cols());
  const StateMatrix before = c.P.llt().solve(I);
  const StateMatrix weighted = c.z.R.llt().solve(c.z.H).transpose();
  const StateMatrix P = (before + weighted * c.z.H).eval().llt().solve(I);
  return {P, P * (weighted * c.z.r)};
}

/// Of the error that is left after the attitude was moved by exp(turn), by the error before, where
/// that is `turn`: central differences, good to 1e-9 (steps of 1e-5, third derivatives about 1).
Eigen::Matrix3d reset_by_differences(const Eigen::Vector3d& turn) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix3d J;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Quaterniond back = so3::exp(turn).conjugate();
    J.col(i) = (so3::log(back * so3::exp(turn + step)) - so3::log(back * so3::exp(turn - step))) /
               (2 * kStep);
  }
  return J;
}

StateMatrix turned_by_reset(const InformationForm& expected) {
  StateMatrix T = StateMatrix::Identity(expected.P.rows(), expected.P.cols());
  part(T, block::attitude, block::attitude) =
      reset_by_differences(part(expected.error, block::attitude));
  return T * expected.P * T.transpose();
}

class KalmanUpdate : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(SlowSizes, KalmanUpdate, ::testing::Values(0, 5, kMostSlow));

TEST_P(KalmanUpdate, EqualsTheInformationForm) {
  double most_turned = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Case c = random_case(seed, GetParam());
    const InformationForm expected = by_information(c);
    NavState x = c.x;
    StateMatrix P = c.P;
    kalman_update(c.z, x, P);

    const StateVector moved = boxminus(x, c.x);
    EXPECT_LT((moved - expected.error).tail(moved.size() - 3).norm(), kRounding);
    EXPECT_LT((moved - expected.error).norm(), 1e-8);  // a position is rounded to nanometres
    EXPECT_LT((P - turned_by_reset(expected)).cwiseAbs().maxCoeff(), 1e-8);  // the differences'
    most_turned = std::max(most_turned, (P - expected.P).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(most_turned, 1e-2);  // else the reset would not be seen
}

TEST_P(KalmanUpdate, WithoutAnInnovationLeavesTheState) {
  Case c = random_case(31, GetParam());
  c.z.r.setZero();
  const InformationForm expected = by_information(c);
  const NavState before = c.x;
  kalman_update(c.z, c.x, c.P);
  EXPECT_LT(boxminus(c.x, before).norm(), 1e-15);
  EXPECT_LT((c.P - expected.P).cwiseAbs().maxCoeff(), kRounding);
}

/// With the noise of both independent. Nothing moves, so nothing is reset between them.
TEST_P(KalmanUpdate, OfSixRowsEqualsTwoOfThree) {
  Case c = random_case(32, GetParam());
  c.z.r.setZero();
  c.z.R.topRightCorner<3, 3>().setZero();
  c.z.R.bottomLeftCorner<3, 3>().setZero();
  StateMatrix in_two = c.P;
  for (const int first : {0, 3}) {
    Linearized half(3, static_cast<int>(c.P.cols()));
    half.r = c.z.r.segment<3>(first);
    half.H = c.z.H.middleRows<3>(first);
    half.R = c.z.R.block<3, 3>(first, first);
    NavState x = c.x;
    kalman_update(half, x, in_two);
  }
  kalman_update(c.z, c.x, c.P);
  EXPECT_LT((c.P - in_two).cwiseAbs().maxCoeff(), kRounding);
}

/// Of all rows at once, as a restart has it.
TEST_P(KalmanUpdate, TakesAsManyRowsAsAStateHas) {
  const Case c = random_case(33, GetParam());
  const int size = static_cast<int>(c.P.rows());
  LinearizedState z(size, size);
  z.H.setIdentity();
  z.r = StateVector::Zero(size);
  z.R = c.P;
  NavState x = c.x;
  StateMatrix P = c.P;
  kalman_update(z, x, P);
  EXPECT_LT((P - 0.5 * c.P).cwiseAbs().maxCoeff(), kRounding);
}

/// Measurements of sigmas 3e4 times as small as what was known, again and again: the smallest
/// eigenvalue comes down to 4e-14 of the largest, a hundred times what rounding does to it.
TEST_P(KalmanUpdate, StaysSymmetricAndPositive) {
  Case c = random_case(34, GetParam());
  c.z.R *= 1e-9;
  c.z.r.setZero();
  for (int i = 0; i < 200; ++i) kalman_update(c.z, c.x, c.P);
  EXPECT_EQ(c.P, c.P.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(c.P);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
}

TEST(InnovationOf, AddsBothNoises) {
  for (const int slow_size : {0, 5}) {
    const Case c = random_case(35, slow_size, 4);
    const Innovation innovation = innovation_of(c.z, c.P);
    EXPECT_EQ(innovation.value, c.z.r);
    ASSERT_EQ(innovation.covariance.rows(), 4);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double expected = c.z.H.row(i) * c.P * c.z.H.row(j).transpose() + c.z.R(i, j);
        EXPECT_NEAR(innovation.covariance(i, j), expected, kRounding);
      }
    }
  }
}

/// Errors drawn from P and noise from R have the covariance that is promised.
TEST(InnovationOf, IsThatOfSampledErrors) {
  const Case c = random_case(36, 5, 3);
  const StateMatrix root = c.P.llt().matrixL();
  const Eigen::Matrix3d noise = Eigen::Matrix3d(c.z.R).llt().matrixL();
  std::mt19937 rng{37};
  constexpr int kSamples = 20'000;
  const Innovation innovation = innovation_of(c.z, c.P);
  const Eigen::LLT<Eigen::Matrix3d> llt(Eigen::Matrix3d(innovation.covariance));
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    const StateVector error = root * draw(rng, c.P.rows());
    const Eigen::Vector3d r = c.z.H * error + noise * draw3(rng);
    sum += r.dot(llt.solve(r));
  }
  // A chi-square of 3 degrees of freedom: 3 on average, sigma sqrt(6 / n) = 0.017; four of them.
  EXPECT_NEAR(sum / kSamples, 3, 0.07);
}

}  // namespace
}  // namespace foucault::state
