#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>
// The manifold matchers of Ceres need the namespace open.
#include <ceres/manifold_test_utils.h>

#include <random>

#include "../../preintegration/tests/closed_form_motion.h"
#include "cartesian_fix.h"
#include "foucault/fgo/observation_factor.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/fgo/prior_factor.h"
#include "foucault/fgo/state_block.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"

namespace foucault::fgo {
namespace {

using namespace ceres;  // NOLINT: EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD needs it in Ceres 2.1
using Eigen::Matrix3d;
using Eigen::Vector3d;

state::NodeState random_state(std::mt19937& rng, double rotation) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&](double scale) {
    return Vector3d(scale * Vector3d(u(rng), u(rng), u(rng)));
  };
  state::NodeState x;
  x.p_w_b = draw(10);
  x.v_w_b = draw(5);
  x.q_w_b = so3::exp(draw(rotation));
  x.bias = {draw(0.01), draw(0.1)};
  return x;
}

StateBlock block_of(const state::NodeState& x) {
  StateBlock block;
  write_block(x, block.data());
  return block;
}

preintegration::Preintegration lively_preintegration() {
  imu::ImuNoise noise;
  noise.gyro_noise_density = 1e-2;
  noise.accel_noise_density = 1e-1;
  noise.gyro_bias_sigma = 1e-2;
  noise.accel_bias_sigma = 1e-1;
  noise.bias_tau = 5;
  const testing::ClosedFormMotion motion(testing::wuhan_earth());
  return testing::preintegrate(motion.increments(2, 3, 100), noise);
}

preintegration::EarthModel fast_earth() {
  preintegration::EarthModel earth = testing::wuhan_earth();
  earth.omega_ie_w *= 1000;  // so that its Jacobians do not hide below the differences' rounding
  return earth;
}

/// Blocks of a factor: nodes, and the border if there is one.
using Blocks = std::vector<std::vector<double>>;

Blocks blocks_of(const std::vector<state::NodeState>& nodes,
                 const std::vector<double>& border = {}) {
  Blocks blocks;
  for (const state::NodeState& node : nodes) {
    const StateBlock block = block_of(node);
    blocks.emplace_back(block.begin(), block.end());
  }
  if (!border.empty()) blocks.push_back(border);
  return blocks;
}

/// Compares with Ceres' own differences, and checks that a block may be left out.
void probe(const CostFunction& factor, const Blocks& at, double step = 1e-6,
           double tolerance = 1e-7) {
  const StateManifold manifold;
  std::vector<const Manifold*> manifolds;
  std::vector<const double*> blocks;
  for (const std::vector<double>& block : at) {
    manifolds.push_back(block.size() == kStateBlockSize ? &manifold : nullptr);
    blocks.push_back(block.data());
  }

  NumericDiffOptions differences;
  differences.relative_step_size = step;
  const GradientChecker checker(&factor, &manifolds, differences);
  GradientChecker::ProbeResults results;
  // Its own verdict is relative entry by entry, and fails on entries that are rounding alone; the
  // differences here are judged against the largest entry of their block.
  checker.Probe(blocks.data(), 1e-6, &results);
  ASSERT_TRUE(results.return_value);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Eigen::MatrixXd difference =
        results.local_jacobians[i] - results.local_numeric_jacobians[i];
    EXPECT_LE(difference.cwiseAbs().maxCoeff(),
              tolerance * results.local_jacobians[i].cwiseAbs().maxCoeff())
        << "block " << i;
  }

  const int rows = factor.num_residuals();
  using AmbientJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto zero = [&](std::size_t i) {
    return AmbientJacobian(AmbientJacobian::Zero(rows, static_cast<Eigen::Index>(at[i].size())));
  };
  std::vector<AmbientJacobian> all;
  for (std::size_t i = 0; i < at.size(); ++i) all.push_back(zero(i));
  std::vector<double*> wanted;
  for (AmbientJacobian& J : all) wanted.push_back(J.data());
  Eigen::VectorXd residual(rows);
  ASSERT_TRUE(factor.Evaluate(blocks.data(), residual.data(), wanted.data()));
  for (std::size_t left_out = 0; left_out < at.size(); ++left_out) {
    std::vector<AmbientJacobian> some;
    for (std::size_t i = 0; i < at.size(); ++i) some.push_back(zero(i));
    for (std::size_t i = 0; i < at.size(); ++i)
      wanted[i] = i == left_out ? nullptr : some[i].data();
    ASSERT_TRUE(factor.Evaluate(blocks.data(), residual.data(), wanted.data()));
    for (std::size_t i = 0; i < at.size(); ++i)
      EXPECT_EQ(some[i], i == left_out ? zero(i) : all[i]);
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
  const state::NodeState at = random_state(rng_, GetParam());
  std::uniform_real_distribution<double> u(-0.5, 0.5);
  Vector delta(15), x(16), y(16);
  for (int i = 0; i < 15; ++i) delta[i] = u(rng_);
  write_block(at, x.data());
  const state::NodeVector step = 0.8 * delta.reverse();
  write_block(state::boxplus(at, step), y.data());  // same hemisphere as x
  EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, 1e-9);
}

TEST_P(FactorAtRotation, PreintegrationJacobians) {
  const PreintegrationFactor factor(lively_preintegration(), fast_earth());
  const state::NodeState x0 = random_state(rng_, GetParam());
  const state::NodeState x1 = random_state(rng_, GetParam());
  probe(factor, blocks_of({x0, x1}));
  const state::NodeState close = predict(x0, factor.preintegration(), factor.earth());
  probe(factor, blocks_of({x0, close}));
}

GraphContext wuhan(const state::Layout& layout = {}) {
  return {geodesy::LocalFrame({0.53, 2.0, 20}), preintegration::PreintegrationModel::full, layout};
}

GnssFix fix_near_origin() {
  GnssFix fix;
  fix.antenna = wuhan().frame.to_geodetic({1, 2, 3});
  fix.p_b_a = {0.5, -1.2, 0.8};
  fix.position_covariance << 0.04, 0.01, 0, 0.01, 0.05, 0.02, 0, 0.02, 0.1;
  fix.velocity_n = Vector3d(0.3, -2, 0.1);
  fix.velocity_covariance = 0.1 * fix.position_covariance;
  return fix;
}

/// Geodetic coordinates are rounded to 1e-9 m, so differences need long steps.
TEST_P(FactorAtRotation, ObservationJacobians) {
  const GraphContext context = wuhan();
  const state::NodeState x = random_state(rng_, GetParam());
  const Vector3d rate_b(0.3, -0.2, 0.7);
  for (const measurement::ObservationPtr& z : {measurement::gnss_position(fix_near_origin()),
                                               measurement::gnss_velocity(fix_near_origin())}) {
    const ObservationFactor factor({z, {rate_b, {}}}, x, state::SlowVector(0), context);
    probe(factor, blocks_of({x}), 1e-3, 1e-5);
  }
}

/// A speed whose scale is a block, and a height.
class ScaledSpeed final : public measurement::Observation {
 public:
  static constexpr state::Block kScale{"speed_scale", 1, "1"};
  std::string_view name() const override { return "scaled_speed"; }
  state::Linearized linearize(const state::NavState& x, const measurement::MeanMotion&,
                              const state::Layout& layout) const override {
    const Eigen::Index column = state::kNodeSize + *layout.slow_index(kScale);
    const double speed = x.velocity_n.norm();
    state::Linearized z(2, layout.size());
    z.r << 3 - (1 + x.slow[0]) * speed, 1 - x.position.height;
    z.H.row(0).segment<3>(state::block::velocity.offset) =
        (1 + x.slow[0]) / speed * x.velocity_n.transpose();
    z.H(0, column) = speed;
    z.H(1, state::block::position.offset + 2) = -1;
    z.R = Eigen::Matrix2d::Identity() * 0.3;
    return z;
  }
};

TEST_P(FactorAtRotation, ObservationJacobiansWithABorder) {
  const GraphContext context = wuhan(state::Layout().add(ScaledSpeed::kScale, 0.1));
  const state::NodeState x = random_state(rng_, GetParam());
  const ObservationFactor factor({std::make_shared<ScaledSpeed>(), {}}, x,
                                 state::SlowVector::Constant(1, 0.2), context);
  probe(factor, blocks_of({x}, {0.2}), 1e-3, 1e-5);
}

TEST_P(FactorAtRotation, PriorJacobians) {
  std::uniform_real_distribution<double> u(-1, 1);
  for (const int slow : {0, 2}) {
    state::StateMatrix A(state::kNodeSize + slow, state::kNodeSize + slow);
    for (double& a : A.reshaped()) a = u(rng_);
    const state::StateMatrix covariance =
        A * A.transpose() +
        state::StateMatrix::Identity(state::kNodeSize + slow, state::kNodeSize + slow);
    const state::NodeState at = random_state(rng_, GetParam());
    SquareRootPrior prior =
        prior_from_covariance(at, state::SlowVector::Constant(slow, 0.1), covariance);
    prior.r.setLinSpaced(-1, 1);
    const std::vector<double> border(slow, 0.3);
    probe(PriorFactor(prior), blocks_of({at}, border));
    probe(PriorFactor(prior), blocks_of({random_state(rng_, GetParam())}, border));
  }
}

TEST_P(FactorAtRotation, PreintegrationWithABorder) {
  const state::Layout layout = state::Layout().add(ScaledSpeed::kScale, 0.1);
  const PreintegrationFactor factor(lively_preintegration(), fast_earth(), layout);
  const state::NodeState x0 = random_state(rng_, GetParam());
  const state::NodeState x1 = random_state(rng_, GetParam());
  probe(factor, blocks_of({x0, x1}, {0.2}));
}

/// What a fix says 50 km from the origin, by its observation and Cartesian in w.
TEST(ObservationFactor, IsTheCartesianFixFarFromTheOrigin) {
  const GraphContext context = wuhan();
  std::mt19937 rng{7};
  state::NodeState x = random_state(rng, 0.8);
  x.p_w_b = {35e3, -36e3, -20};
  // Steps along the ellipsoid differ from straight ones by the square of the arm over the Earth's
  // radius; without an arm, the rounding of geodetic coordinates is left.
  struct Case {
    double arm, tolerance;
  };
  for (const Case& c : {Case{0, 5e-9}, Case{1, 4e-7}}) {
    GnssFix fix = fix_near_origin();
    fix.p_b_a *= c.arm;
    fix.position_covariance.setIdentity();  // metres: whitened is as it is
    fix.antenna =
        context.frame.to_geodetic(x.p_w_b + x.q_w_b * fix.p_b_a + Vector3d(0.02, -0.01, 0.03));
    const testing::CartesianFix other = testing::cartesian(fix, context.frame);
    const ObservationRows z =
        linearize({measurement::gnss_position(fix)}, x, state::SlowVector(0), context);
    const Matrix3d R_w_n = context.frame.R_w_n(fix.antenna);
    EXPECT_LT((R_w_n * z.r + testing::antenna_innovation(x, other)).norm(), c.tolerance);
    EXPECT_LT((R_w_n * z.J - testing::antenna_jacobian(x, other)).norm(), 1e-6);
  }
}

TEST(Factor, WhiteningIsThatOfTheCovariance) {
  const preintegration::Preintegration pre = lively_preintegration();
  const preintegration::EarthModel earth = testing::wuhan_earth();
  const PreintegrationFactor factor(pre, earth);
  std::mt19937 rng{3};
  const state::NodeState x0 = random_state(rng, 0.5);
  const state::NodeState x1 =
      state::boxplus(predict(x0, pre, earth), 0.01 * state::NodeVector::Ones());
  const state::NodeVector r = preintegration::motion_residual_value(x0, x1, pre, earth);
  const double mahalanobis = r.dot(pre.covariance.ldlt().solve(r));
  EXPECT_NEAR(factor.linearize(x0, x1, state::SlowVector(0)).r.squaredNorm(), mahalanobis,
              1e-9 * mahalanobis);
}

TEST(Factor, ThePreintegrationComesBackFromItsSquareRoot) {
  const preintegration::Preintegration pre = lively_preintegration();
  const state::NodeMatrix back =
      PreintegrationFactor(pre, fast_earth()).preintegration().covariance;
  const state::NodeVector scale = pre.covariance.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (back - pre.covariance) * scale.asDiagonal()).norm(), 1e-9);
}

TEST(Factor, RefusesCovariancesThatAreNot) {
  EXPECT_THROW(PreintegrationFactor(preintegration::Preintegration{}, preintegration::EarthModel{}),
               std::invalid_argument);
  GnssFix fix = fix_near_origin();
  fix.position_covariance = -Matrix3d::Identity();
  const GraphContext context = wuhan();
  EXPECT_THROW(
      (ObservationFactor{
          {measurement::gnss_position(fix)}, state::NodeState{}, state::SlowVector(0), context}),
      std::invalid_argument);
  EXPECT_THROW(
      prior_from_covariance(state::NodeState{}, state::SlowVector(0), state::NodeMatrix::Zero()),
      std::invalid_argument);
}

}  // namespace
}  // namespace foucault::fgo
