#include "foucault/state/nav_state.h"

#include <gtest/gtest.h>

#include "random_state.h"

namespace foucault::state {
namespace {

using namespace testing;

/// A coordinate of up to pi rad is rounded to 4.4e-16 rad, 3 nm on the Earth; two of them and the
/// step between come to less than four times that.
constexpr double kPositionRounding = 1e-8;  // [m]
/// Some operations at double precision with values of up to 250.
constexpr double kRounding = 1e-12;

/// Metres, m/s, radians (below pi), biases, slow.
StateVector random_error(std::mt19937& rng, Eigen::Index slow_size) {
  StateVector error(state_size(slow_size));
  part(error, block::position) = 30 * draw3(rng);
  part(error, block::velocity) = 10 * draw3(rng);
  part(error, block::attitude) = between(rng, 0, 3) * draw3(rng).normalized();
  sensor_part(error) = 0.1 * draw(rng, 6 + slow_size);
  return error;
}

void expect_near(const StateVector& a, const StateVector& b) {
  ASSERT_EQ(a.size(), b.size());
  const StateVector difference = (a - b).cwiseAbs();
  EXPECT_LT(part(difference, block::position).maxCoeff(), kPositionRounding);
  EXPECT_LT(difference.tail(a.size() - 3).maxCoeff(), kRounding);
}

void expect_near(const NavState& a, const NavState& b) {
  // Through the coordinates, so that the errors under test play no part.
  constexpr double kAngle = kPositionRounding / 6.3e6;
  EXPECT_NEAR(a.position.latitude, b.position.latitude, kAngle);
  EXPECT_NEAR(a.position.longitude, b.position.longitude, kAngle / std::cos(a.position.latitude));
  EXPECT_NEAR(a.position.height, b.position.height, kPositionRounding);
  EXPECT_LT((a.velocity_n - b.velocity_n).norm(), kRounding);
  EXPECT_LT(a.q_n_b.angularDistance(b.q_n_b), 1e-7);  // acos near 1: root of the rounding
  EXPECT_LT((a.bias.gyro - b.bias.gyro).norm(), kRounding);
  EXPECT_LT((a.bias.accel - b.bias.accel).norm(), kRounding);
  ASSERT_EQ(a.slow.size(), b.slow.size());
  EXPECT_LT((a.slow - b.slow).norm(), kRounding);
}

class NavStates : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(SlowSizes, NavStates, ::testing::Values(0, 5, kMostSlow));

TEST_P(NavStates, BoxminusUndoesBoxplus) {
  std::mt19937 rng{42};
  for (int i = 0; i < 200; ++i) {
    const NavState x = random_state(rng, GetParam());
    const StateVector error = random_error(rng, GetParam());
    expect_near(boxminus(boxplus(x, error), x), error);
  }
}

TEST_P(NavStates, BoxplusUndoesBoxminus) {
  std::mt19937 rng{43};
  for (int i = 0; i < 200; ++i) {
    const NavState x = random_state(rng, GetParam());
    NavState y = random_state(rng, GetParam());
    y.position = {x.position.latitude + 1e-4 * between(rng, -1, 1),
                  so3::wrap(x.position.longitude + 1e-4 * between(rng, -1, 1)),
                  between(rng, -100, 12e3)};
    expect_near(boxplus(x, boxminus(y, x)), y);
  }
}

TEST_P(NavStates, AreNoErrorApartFromThemselves) {
  std::mt19937 rng{44};
  const NavState x = random_state(rng, GetParam());
  EXPECT_LT(boxminus(x, x).norm(), 1e-15);
}

/// The steps are metres north, east, down, and the attitude's is on the right.
TEST(NavState, ErrorIsWhatTheBlocksSay) {
  std::mt19937 rng{45};
  const NavState x = random_state(rng, 0);
  StateVector error = random_error(rng, 0);
  const Eigen::Vector3d turn = part(error, block::attitude);
  const NavState y = boxplus(x, error);
  EXPECT_LT(y.q_n_b.angularDistance(x.q_n_b * so3::exp(turn)), 1e-7);
  EXPECT_GT(y.q_n_b.angularDistance(so3::exp(turn) * x.q_n_b), 0.01);
  EXPECT_NEAR(x.position.height - y.position.height, part(error, block::position).z(),
              kPositionRounding);
  EXPECT_EQ(y.velocity_n, x.velocity_n + part(error, block::velocity));
  EXPECT_EQ(y.bias.gyro, x.bias.gyro + part(error, block::gyro_bias));
  EXPECT_EQ(y.bias.accel, x.bias.accel + part(error, block::accel_bias));
  EXPECT_EQ(y.t_ns, x.t_ns);
}

TEST(NavState, ShortestWayLeadsOverTheDateLine) {
  std::mt19937 rng{46};
  for (const double side : {1.0, -1.0}) {
    for (int i = 0; i < 50; ++i) {
      NavState x = random_state(rng, 3);
      x.position.latitude = between(rng, -1, 1);
      x.position.longitude = side * (kPi - 1e-6);  // 3 to 6 m from the line
      StateVector error = random_error(rng, 3);
      part(error, block::position).y() = side * 100;
      const NavState y = boxplus(x, error);
      EXPECT_LT(side * y.position.longitude, 0);
      EXPECT_LE(std::abs(y.position.longitude), kPi);
      expect_near(boxminus(y, x), error);
      expect_near(boxplus(x, boxminus(y, x)), y);
    }
  }
}

TEST(NavState, ErrorOfANodeAloneLeavesSlowBlocks) {
  std::mt19937 rng{47};
  const NavState x = random_state(rng, 5);
  const StateVector error = random_error(rng, 0);
  const NavState y = boxplus(x, error);
  EXPECT_EQ(y.slow, x.slow);
  StateVector with_zeros = StateVector::Zero(state_size(5));
  node_part(with_zeros) = error;
  expect_near(boxminus(y, x), with_zeros);
}

NodeState random_node(std::mt19937& rng) {
  NodeState x;
  x.p_w_b = 1000 * draw3(rng);
  x.v_w_b = 30 * draw3(rng);
  x.q_w_b = Eigen::Quaterniond(Eigen::Vector4d(draw(rng, 4))).normalized();
  x.bias = {1e-2 * draw3(rng), 0.1 * draw3(rng)};
  return x;
}

TEST(NodeState, BoxminusUndoesBoxplus) {
  std::mt19937 rng{48};
  for (int i = 0; i < 200; ++i) {
    const NodeState x = random_node(rng);
    const NodeVector error = random_error(rng, 0);
    // Metres in the thousands are rounded to 1e-12 each.
    EXPECT_LT((boxminus(boxplus(x, error), x) - error).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(NodeState, BoxplusUndoesBoxminus) {
  std::mt19937 rng{49};
  for (int i = 0; i < 200; ++i) {
    const NodeState x = random_node(rng);
    const NodeState y = random_node(rng);
    const NodeState z = boxplus(x, boxminus(y, x));
    EXPECT_LT((z.p_w_b - y.p_w_b).norm(), 1e-11);
    EXPECT_LT((z.v_w_b - y.v_w_b).norm(), 1e-11);
    EXPECT_LT(z.q_w_b.angularDistance(y.q_w_b), 1e-7);
    EXPECT_LT((z.bias.gyro - y.bias.gyro).norm(), kRounding);
    EXPECT_LT((z.bias.accel - y.bias.accel).norm(), kRounding);
  }
}

}  // namespace
}  // namespace foucault::state
