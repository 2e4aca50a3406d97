#include "foucault/preintegration/motion.h"

#include <gtest/gtest.h>

#include <random>

#include "closed_form_motion.h"
#include "foucault/imu/increments.h"

namespace foucault::preintegration {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::ClosedFormMotion;
using testing::preintegrate;
using testing::wuhan_earth;
using namespace state::block;

state::NodeVector prediction_error(const ClosedFormMotion& motion, const EarthModel& model,
                                   double begin, double end, double rate_hz) {
  const Preintegration pre = preintegrate(motion.increments(begin, end, rate_hz));
  return state::boxminus(predict(motion.state(begin), pre, model), motion.state(end));
}

TEST(Motion, LandsOnExactTruthWithSecondOrderInDt) {
  const ClosedFormMotion motion(wuhan_earth());
  const state::NodeVector coarse = prediction_error(motion, wuhan_earth(), 2, 3, 50);
  const state::NodeVector fine = prediction_error(motion, wuhan_earth(), 2, 3, 100);
  const state::NodeVector finest = prediction_error(motion, wuhan_earth(), 2, 3, 200);
  // Position by trapezoid (20): error a_dot dt^2 T / 12, about 5e-6 m here at 200 Hz.
  EXPECT_LT(state::part(finest, position).norm(), 1e-5);
  // Velocity: rates that change otherwise than linearly within two samples, 6e-9 m/s.
  EXPECT_LT(state::part(finest, velocity).norm(), 1e-8);
  EXPECT_LT(state::part(finest, attitude).norm(), 1e-8);
  const double order =
      std::log2(state::part(coarse, position).norm() / state::part(fine, position).norm());
  EXPECT_NEAR(order, 2, 0.1);
  const double attitude_order =
      std::log2(state::part(coarse, attitude).norm() / state::part(fine, attitude).norm());
  EXPECT_NEAR(attitude_order, 3, 0.1);  // (15) with the previous sample
}

TEST(Motion, WithoutTheEarthTheSameTestFails) {
  const ClosedFormMotion motion(wuhan_earth());
  EarthModel still = wuhan_earth();
  still.omega_ie_w.setZero();
  const state::NodeVector error = prediction_error(motion, still, 2, 3, 200);
  EXPECT_NEAR(state::part(error, attitude).norm(), 7.292e-5, 1e-7);  // 15 deg/h for one second
  // Of the order of 2 w v T = 1.8 mm/s and half of it in position: a hundred times the bounds
  // above.
  EXPECT_GT(state::part(error, velocity).norm(), 3e-4);
  EXPECT_GT(state::part(error, position).norm(), 1e-4);
}

/// Gravity that changes ten thousand times faster with the place than the real one.
EarthModel steep_earth() {
  EarthModel earth = wuhan_earth();
  earth.gravity_gradient = (1.5e-2 * Vector3d(-1, -1, 2)).asDiagonal();
  earth.gravity_gradient(0, 2) = earth.gravity_gradient(2, 0) = 3e-3;
  earth.p_ref = {3, -2, 1};
  return earth;
}

TEST(Motion, LandsOnExactTruthWhereGravityChangesWithThePlace) {
  const ClosedFormMotion motion(steep_earth());
  const state::NodeVector error = prediction_error(motion, steep_earth(), 2, 2.2, 200);
  // Gravity follows the way within the interval, as it would be without the change of gravity:
  // left is G^2 v T^4 / 24 = 1.8e-7 m/s.
  EXPECT_LT(state::part(error, velocity).norm(), 3e-7);
  EarthModel constant = steep_earth();
  constant.g_w = steep_earth().gravity(motion.p(2));
  constant.gravity_gradient.setZero();
  const state::NodeVector without = prediction_error(motion, constant, 2, 2.2, 200);
  EXPECT_GT(state::part(without, velocity).norm(), 1e-3);  // G v T^2 / 2
}

TEST(Motion, RestOnTheEarthStaysAtRest) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion rest(earth, 0);
  const state::NodeVector error = prediction_error(rest, earth, 0, 60, 200);
  // To first order in w T the velocity would be wrong by w^2 g T^3 / 6, 1.9 mm/s, after a minute.
  // What is left is the end of the series, (w T)^4 g T / 120.
  EXPECT_LT(state::part(error, velocity).norm(), 2e-9);
  EXPECT_LT(state::part(error, position).norm(), 1e-7);
  EXPECT_LT(state::part(error, attitude).norm(), 1e-12);
}

/// Section III to the letter: (13), (16)-(20) and (21)-(29), attitude used while integrating,
/// positions summed for (29).
struct PaperIntegral {
  Vector3d dv = Vector3d::Zero(), dp = Vector3d::Zero(), cor_p = Vector3d::Zero();
};

PaperIntegral integrate_as_printed(const std::vector<ImuIncrement>& increments,
                                   const state::NodeState& x0, const EarthModel& earth) {
  PaperIntegral out;
  const Matrix3d R0 = x0.q_w_b.toRotationMatrix();
  Quaterniond q = Quaterniond::Identity();
  double t = 0;
  Vector3d p = Vector3d::Zero(), v = x0.v_w_b;
  for (std::size_t i = 1; i < increments.size(); ++i) {
    const ImuIncrement& before = increments[i - 1];
    const ImuIncrement& now = increments[i];
    const double dt = now.dt();
    const Vector3d u =
        imu::velocity_with_sculling(before.dtheta_b, before.dvel_b, now.dtheta_b, now.dvel_b);
    const Matrix3d turn = so3::exp(-earth.omega_ie_w * (t + dt / 2)).toRotationMatrix();
    const Vector3d y = R0.transpose() * turn * R0 * (q * u);
    out.dp += dt * (out.dv + y / 2);
    out.dv += y;
    const Vector3d v_next = v + R0 * y + dt * (earth.g_w - 2 * earth.omega_ie_w.cross(v));
    const Vector3d p_next = p + dt / 2 * (v + v_next);
    out.cor_p += 2 * earth.omega_ie_w.cross(dt / 2 * (p + p_next));
    p = p_next;
    v = v_next;
    q = q * so3::exp(imu::rotation_with_coning(before.dtheta_b, now.dtheta_b));
    t += dt;
  }
  return out;
}

TEST(Motion, EqualsThePaperAsPrinted) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const std::vector<ImuIncrement> increments = motion.increments(2, 3, 200);
  const Preintegration pre = preintegrate(increments);
  const state::NodeState x0 = motion.state(2);
  const state::NodeState x1 = predict(x0, pre, earth);
  const PaperIntegral paper = integrate_as_printed(increments, x0, earth);
  const Matrix3d R0t = x0.q_w_b.toRotationMatrix().transpose();
  const Vector3d moved = x1.p_w_b - x0.p_w_b;
  const Vector3d dv_25 =
      R0t * (x1.v_w_b - x0.v_w_b - earth.g_w * pre.dt + 2 * earth.omega_ie_w.cross(moved));
  const Vector3d dp_28 =
      R0t * (moved - x0.v_w_b * pre.dt - earth.g_w * (pre.dt * pre.dt / 2) + paper.cor_p);
  // (w T)^2 dv = 5e-8 m/s, and the sums of the printed form are of first order in dt times w.
  EXPECT_LT((dv_25 - paper.dv).norm(), 1e-7);
  EXPECT_LT((dp_28 - paper.dp).norm(), 1e-7);
}

state::NodeState random_state(std::mt19937& rng, double rotation) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&](double scale) {
    return Vector3d(scale * Vector3d(u(rng), u(rng), u(rng)));
  };
  state::NodeState x;
  x.p_w_b = draw(100);
  x.v_w_b = draw(20);
  x.q_w_b = so3::exp(draw(rotation));
  x.bias.gyro = draw(0.01);
  x.bias.accel = draw(0.1);
  return x;
}

/// Central differences of f about zero, a column for each of kColumns.
template <int kColumns, class Function>
Eigen::Matrix<double, state::kNodeSize, kColumns> numerical_jacobian(const Function& f) {
  using Step = Eigen::Matrix<double, kColumns, 1>;
  Eigen::Matrix<double, state::kNodeSize, kColumns> J;
  for (int i = 0; i < kColumns; ++i) {
    const Step d = 1e-6 * Step::Unit(i);
    J.col(i) = (f(d) - f(Step(-d))) / 2e-6;
  }
  return J;
}

const state::ImuScale kScale{{0.02, -0.03, 0.01}, {-0.01, 0.02, 0.03}};

TEST(Motion, JacobiansAreDerivatives) {
  // An Earth that turns a thousand times faster, so that its terms do not hide in rounding.
  EarthModel earth = steep_earth();
  earth.omega_ie_w *= 1000;
  const ClosedFormMotion motion(earth);
  Preintegration pre = preintegrate(motion.increments(2, 3, 100), {}, {}, kScale);
  pre.gyro_bias_decay = 0.8;
  pre.accel_bias_decay = 0.7;
  std::mt19937 rng{7};
  for (const double rotation : {0.0, 1e-9, 0.5, 1.7}) {
    const state::NodeState x0 = random_state(rng, rotation);
    const state::NodeState x1 = random_state(rng, rotation);
    const state::ImuScale scale{{0.03, 0.01, -0.02}, {0.02, -0.02, 0.01}};
    const MotionResidual m = motion_residual(x0, x1, pre, earth, scale);
    const auto residual = [&](const state::NodeState& begin, const state::NodeState& end,
                              const state::ImuScale& at) {
      return motion_residual_value(begin, end, pre, earth, at);
    };
    const state::NodeMatrix J0 = numerical_jacobian<state::kNodeSize>(
        [&](const state::NodeVector& d) { return residual(state::boxplus(x0, d), x1, scale); });
    const state::NodeMatrix J1 = numerical_jacobian<state::kNodeSize>(
        [&](const state::NodeVector& d) { return residual(x0, state::boxplus(x1, d), scale); });
    const NodeByAxis J_gyro = numerical_jacobian<3>([&](const Vector3d& d) {
      return residual(x0, x1, {scale.gyro + d, scale.accel});
    });
    const NodeByAxis J_accel = numerical_jacobian<3>([&](const Vector3d& d) {
      return residual(x0, x1, {scale.gyro, scale.accel + d});
    });
    // Central differences: rounding of 1e2 m * 1e-16 / 1e-6 and third derivatives * 1e-12.
    EXPECT_LT((m.J_x0 - J0).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    EXPECT_LT((m.J_x1 - J1).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    EXPECT_LT((m.J_gyro_scale - J_gyro).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    EXPECT_LT((m.J_accel_scale - J_accel).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    for (std::size_t i = 0; i < m.J_gyro_cross.size(); ++i) {
      const NodeByAxis J_cross = numerical_jacobian<3>([&](const Vector3d& d) {
        state::ImuScale moved = scale;
        moved.gyro_cross.segment<3>(3 * static_cast<Eigen::Index>(i)) += d;
        return residual(x0, x1, moved);
      });
      EXPECT_LT((m.J_gyro_cross[i] - J_cross).cwiseAbs().maxCoeff(), 2e-7) << i;
    }
    const NodeByAxis J_accel_cross = numerical_jacobian<3>([&](const Vector3d& d) {
      state::ImuScale moved = scale;
      moved.accel_cross += d;
      return residual(x0, x1, moved);
    });
    EXPECT_LT((m.J_accel_cross - J_accel_cross).cwiseAbs().maxCoeff(), 2e-7);
    EXPECT_EQ(m.r, residual(x0, x1, scale));
  }
}

TEST(Motion, ScaleJacobiansAreThoseOfIntegratingAgain) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const std::vector<ImuIncrement> increments = motion.increments(2, 3, 200);
  const state::NodeState x0 = motion.state(2), x1 = motion.state(3);
  const auto again = [&](const state::ImuScale& scale) {
    return motion_residual_value(x0, x1, preintegrate(increments, {}, {}, scale), earth, scale);
  };
  const MotionResidual m =
      motion_residual(x0, x1, preintegrate(increments, {}, {}, kScale), earth, kScale);
  const NodeByAxis J_gyro = numerical_jacobian<3>([&](const Vector3d& d) {
    return again({kScale.gyro + d, kScale.accel});
  });
  const NodeByAxis J_accel = numerical_jacobian<3>([&](const Vector3d& d) {
    return again({kScale.gyro, kScale.accel + d});
  });
  // Coning and sculling are not in the Jacobians: relative 1e-5 at 200 Hz, of 10 or less.
  EXPECT_LT((m.J_gyro_scale - J_gyro).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((m.J_accel_scale - J_accel).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_GT(m.J_gyro_scale.norm(), 1);
  EXPECT_GT(m.J_accel_scale.norm(), 9);
}

/// Error of (46) against integrating again, at errors of the sensors that are `share` of some.
double error_of_linear_correction(double share) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const std::vector<ImuIncrement> increments = motion.increments(2, 3, 200);
  state::NodeState x0 = motion.state(2);
  x0.bias = {share * Vector3d(0.02, -0.01, 0.01), share * Vector3d(0.1, 0.2, -0.1)};
  const state::ImuScale scale{share * kScale.gyro, share * kScale.accel};
  const Preintegration at_zero = preintegrate(increments, {}, {}, state::ImuScale{});
  const Preintegration again = preintegrate(increments, {}, x0.bias, scale);
  return state::boxminus(predict(x0, at_zero, earth, scale), predict(x0, again, earth, scale))
      .norm();
}

TEST(Motion, LinearCorrectionIsOfSecondOrder) {
  const double whole = error_of_linear_correction(0.4);
  const double half = error_of_linear_correction(0.2);
  EXPECT_GT(whole, 1e-5);
  EXPECT_NEAR(whole / half, 4, 0.1);
}

TEST(Motion, LandsOnExactTruthWithTheTrueScale) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const state::ImuScale scale{{1e-3, -1e-3, 1e-3}, {-1e-3, 1e-3, -1e-3}};
  const std::vector<ImuIncrement> recorded =
      testing::measured(motion.increments(2, 3, 200), {}, scale);
  const state::NodeState x0 = motion.state(2), x1 = motion.state(3);
  const auto error = [&](const state::ImuScale& integrated_at,
                         const state::ImuScale& of_the_state) {
    const Preintegration pre = preintegrate(recorded, {}, {}, integrated_at);
    return state::boxminus(predict(x0, pre, earth, of_the_state), x1).norm();
  };
  EXPECT_LT(error(scale, scale), 1e-5);  // as without scale errors, see above
  EXPECT_LT(error({}, scale), 3e-5);     // (1000 ppm)^2 of 10 m/s and m beside it
  EXPECT_GT(error({}, {}), 5e-3);
}

TEST(Motion, PredictionHasNoResidual) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const Preintegration pre = preintegrate(motion.increments(2, 3, 100), {}, {}, state::ImuScale{});
  std::mt19937 rng{11};
  const state::NodeState x0 = random_state(rng, 1);
  const state::NodeState x1 = predict(x0, pre, earth, kScale);
  EXPECT_LT(motion_residual_value(x0, x1, pre, earth, kScale).norm(), 1e-12);
}

TEST(Motion, PredictedCovarianceIsThatOfPerturbedPredictions) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  Preintegration pre = preintegrate(motion.increments(2, 3, 100));
  pre.covariance.setZero();
  const state::NodeState x0 = motion.state(2);
  const state::NodeState x1 = predict(x0, pre, earth);
  const state::NodeMatrix F = numerical_jacobian<state::kNodeSize>([&](const state::NodeVector& d) {
    return state::boxminus(predict(state::boxplus(x0, d), pre, earth), x1);
  });
  state::NodeMatrix P = state::NodeMatrix::Identity();
  P(2, 7) = P(7, 2) = 0.3;
  const state::NodeMatrix expected = F * P * F.transpose();
  EXPECT_LT((predict_covariance(x0, x1, pre, earth, P) - expected).cwiseAbs().maxCoeff(),
            1e-6 * expected.cwiseAbs().maxCoeff());
}

const state::Block kOther{"other", 2, "1"};  ///< does not act on the IMU

state::Layout slow_blocks() {
  return state::Layout()
      .add(state::block::accel_scale, 0.03)
      .add(kOther, 0.5)
      .add(state::block::gyro_scale, 0.02);
}

state::StateMatrix random_covariance(int size, unsigned seed) {
  std::mt19937 rng{seed};
  std::normal_distribution<double> normal;
  state::StateMatrix A(size, size);
  for (double& a : A.reshaped()) a = normal(rng);
  return A * A.transpose();
}

TEST(Motion, PredictedCovarianceWithSlowBlocksIsThatOfPerturbedPredictions) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const state::Layout layout = slow_blocks();
  const int n = layout.slow_size();
  imu::ImuNoise noise;
  noise.gyro_noise_density = 0.1;
  noise.accel_noise_density = 0.3;
  noise.gyro_bias_sigma = noise.accel_bias_sigma = 0.1;
  state::SlowVector slow(n);
  slow << 0.01, -0.01, 0.02, 5, 5, 0.02, 0.01, -0.03;
  const Preintegration pre =
      preintegrate(motion.increments(2, 3, 100), noise, {}, layout.imu_scale(slow));
  const state::NodeState x0 = motion.state(2);
  const state::NodeState x1 = predict(x0, pre, earth, layout.imu_scale(slow));

  state::StateMatrix phi = state::StateMatrix::Zero(layout.size(), layout.size());
  for (int i = 0; i < layout.size(); ++i) {
    const auto moved = [&](double step) {
      const state::StateVector d = step * state::StateVector::Unit(layout.size(), i);
      const state::SlowVector slow_moved = slow + d.tail(n);
      const state::NodeVector node = d.head<state::kNodeSize>();
      return state::boxminus(
          predict(state::boxplus(x0, node), pre, earth, layout.imu_scale(slow_moved)), x1);
    };
    phi.col(i).head<state::kNodeSize>() = (moved(1e-6) - moved(-1e-6)) / 2e-6;
  }
  phi.diagonal().tail(n).setOnes();
  const state::StateMatrix P = random_covariance(layout.size(), 3);
  state::StateMatrix expected = phi * P * phi.transpose();
  const state::StateMatrix nothing = state::StateMatrix::Zero(layout.size(), layout.size());
  expected += predict_covariance(x0, x1, pre, earth, nothing, layout, slow);

  const state::StateMatrix predicted = predict_covariance(x0, x1, pre, earth, P, layout, slow);
  // Rounding in central differences: 1e2 m * 1e-16 / 1e-6.
  const state::StateVector s = expected.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((s.asDiagonal() * (predicted - expected) * s.asDiagonal()).cwiseAbs().maxCoeff(), 3e-8);
}

}  // namespace
}  // namespace foucault::preintegration
