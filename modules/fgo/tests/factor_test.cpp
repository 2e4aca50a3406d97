#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>
// The manifold matchers of Ceres need the namespace open.
#include <ceres/manifold_test_utils.h>

#include <random>

#include "../../preintegration/tests/closed_form_motion.h"
#include "foucault/fgo/gnss_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/state_block.h"

namespace foucault {
namespace {

using namespace ceres;  // NOLINT: EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD needs it in Ceres 2.1
using Eigen::Matrix3d;
using Eigen::Vector3d;

NodeState random_state(std::mt19937& rng, double rotation) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&](double scale) {
    return Vector3d(scale * Vector3d(u(rng), u(rng), u(rng)));
  };
  NodeState x;
  x.p_w_b = draw(10);
  x.v_w_b = draw(5);
  x.q_w_b = so3::exp(draw(rotation));
  x.bias = {draw(0.01), draw(0.1)};
  return x;
}

StateBlock block_of(const NodeState& x) {
  StateBlock block;
  write_block(x, block.data());
  return block;
}

Preintegration lively_preintegration() {
  ImuNoise noise;
  noise.gyro_noise_density = 1e-2;
  noise.accel_noise_density = 1e-1;
  noise.gyro_bias_sigma = 1e-2;
  noise.accel_bias_sigma = 1e-1;
  noise.bias_tau = 5;
  const testing::ClosedFormMotion motion(testing::wuhan_earth());
  return testing::preintegrate(motion.increments(2, 3, 100), noise);
}

EarthModel fast_earth() {
  EarthModel earth = testing::wuhan_earth();
  earth.omega_ie_w *= 1000;  // so that its Jacobians do not hide below the differences' rounding
  return earth;
}

/// Compares with Ceres' own differences, and checks that a block may be left out.
void probe(const CostFunction& factor, const std::vector<StateBlock>& states) {
  const StateManifold manifold;
  const std::vector<const Manifold*> manifolds(states.size(), &manifold);
  std::vector<const double*> blocks;
  for (const StateBlock& state : states) blocks.push_back(state.data());

  const GradientChecker checker(&factor, &manifolds, NumericDiffOptions{});
  GradientChecker::ProbeResults results;
  // Its own verdict is relative entry by entry, and fails on entries that are rounding alone; the
  // differences here are judged against the largest entry of their block.
  checker.Probe(blocks.data(), 1e-6, &results);
  ASSERT_TRUE(results.return_value);
  for (std::size_t i = 0; i < states.size(); ++i) {
    const Eigen::MatrixXd difference =
        results.local_jacobians[i] - results.local_numeric_jacobians[i];
    EXPECT_LT(difference.cwiseAbs().maxCoeff(),
              1e-7 * results.local_jacobians[i].cwiseAbs().maxCoeff())
        << "block " << i;
  }

  const int rows = factor.num_residuals();
  using AmbientJacobian = Eigen::Matrix<double, Eigen::Dynamic, 16, Eigen::RowMajor>;
  std::vector<AmbientJacobian> all(states.size(), AmbientJacobian(rows, 16));
  std::vector<double*> wanted;
  for (AmbientJacobian& J : all) wanted.push_back(J.data());
  Eigen::VectorXd residual(rows);
  ASSERT_TRUE(factor.Evaluate(blocks.data(), residual.data(), wanted.data()));
  for (std::size_t left_out = 0; left_out < states.size(); ++left_out) {
    std::vector<AmbientJacobian> some(states.size(), AmbientJacobian::Zero(rows, 16));
    for (std::size_t i = 0; i < states.size(); ++i)
      wanted[i] = i == left_out ? nullptr : some[i].data();
    ASSERT_TRUE(factor.Evaluate(blocks.data(), residual.data(), wanted.data()));
    for (std::size_t i = 0; i < states.size(); ++i)
      EXPECT_EQ(some[i], i == left_out ? AmbientJacobian(AmbientJacobian::Zero(rows, 16)) : all[i]);
  }
}

class FactorAtRotation : public ::testing::TestWithParam<double> {
 protected:
  std::mt19937 rng_{42};
};
INSTANTIATE_TEST_SUITE_P(IdentityTinyAndLarge, FactorAtRotation,
                         ::testing::Values(0.0, 1e-10, 1e-4, 0.7, 1.2));

TEST_P(FactorAtRotation, ManifoldInvariants) {
  const StateManifold manifold;
  const NodeState at = random_state(rng_, GetParam());
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  Vector delta(15), x(16), y(16);
  for (int i = 0; i < 15; ++i) delta[i] = u(rng_);
  write_block(at, x.data());
  const Vector15d step = 0.8 * delta.reverse();
  write_block(boxplus(at, step), y.data());  // same hemisphere as x
  EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, 1e-9);
}

TEST_P(FactorAtRotation, PreintegrationJacobians) {
  const PreintegrationFactor factor(lively_preintegration(), fast_earth());
  const NodeState x0 = random_state(rng_, GetParam());
  const NodeState x1 = random_state(rng_, GetParam());
  probe(factor, {block_of(x0), block_of(x1)});
  const NodeState close = predict(x0, factor.preintegration(), factor.earth());
  probe(factor, {block_of(x0), block_of(close)});
}

TEST_P(FactorAtRotation, GnssJacobians) {
  LocalFix fix;
  fix.p_w_a = {1, 2, 3};
  fix.p_b_a = {0.5, -1.2, 0.8};
  fix.covariance_w << 0.04, 0.01, 0, 0.01, 0.05, 0.02, 0, 0.02, 0.1;
  probe(GnssFactor(fix), {block_of(random_state(rng_, GetParam()))});
}

TEST_P(FactorAtRotation, PriorJacobians) {
  Matrix15d A;
  std::uniform_real_distribution<double> u(-1, 1);
  for (double& a : A.reshaped()) a = u(rng_);
  const NodeState at = random_state(rng_, GetParam());
  SquareRootPrior prior = prior_from_covariance(at, A * A.transpose() + Matrix15d::Identity());
  prior.r.setLinSpaced(-1, 1);
  probe(PriorFactor(prior), {block_of(at)});
  probe(PriorFactor(prior), {block_of(random_state(rng_, GetParam()))});
}

TEST(Factor, WhiteningIsThatOfTheCovariance) {
  const Preintegration pre = lively_preintegration();
  const EarthModel earth = testing::wuhan_earth();
  const PreintegrationFactor factor(pre, earth);
  std::mt19937 rng{3};
  const NodeState x0 = random_state(rng, 0.5);
  const NodeState x1 = boxplus(predict(x0, pre, earth), 0.01 * Vector15d::Ones());
  const Vector15d r = motion_residual_value(x0, x1, pre, earth);
  const double mahalanobis = r.dot(pre.covariance.ldlt().solve(r));
  EXPECT_NEAR(factor.linearize(x0, x1).r.squaredNorm(), mahalanobis, 1e-9 * mahalanobis);
}

TEST(Factor, RefusesCovariancesThatAreNot) {
  EXPECT_THROW(PreintegrationFactor(Preintegration{}, EarthModel{}), std::invalid_argument);
  LocalFix fix;
  fix.covariance_w = -Matrix3d::Identity();
  EXPECT_THROW(GnssFactor{fix}, std::invalid_argument);
  EXPECT_THROW(prior_from_covariance(NodeState{}, Matrix15d::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace foucault
