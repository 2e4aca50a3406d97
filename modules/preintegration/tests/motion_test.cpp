#include "foucault/preintegration/motion.h"

#include <gtest/gtest.h>

#include <random>

#include "closed_form_motion.h"
#include "foucault/inertial/increments.h"

namespace foucault {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::ClosedFormMotion;
using testing::preintegrate;
using testing::wuhan_earth;
using namespace error_state;

Vector15d prediction_error(const ClosedFormMotion& motion, const EarthModel& model, double begin,
                           double end, double rate_hz) {
  const Preintegration pre = preintegrate(motion.increments(begin, end, rate_hz));
  return boxminus(predict(motion.state(begin), pre, model), motion.state(end));
}

TEST(Motion, LandsOnExactTruthWithSecondOrderInDt) {
  const ClosedFormMotion motion(wuhan_earth());
  const Vector15d coarse = prediction_error(motion, wuhan_earth(), 2, 3, 50);
  const Vector15d fine = prediction_error(motion, wuhan_earth(), 2, 3, 100);
  const Vector15d finest = prediction_error(motion, wuhan_earth(), 2, 3, 200);
  // Position by trapezoid (20): error a_dot dt^2 T / 12, about 5e-6 m here at 200 Hz.
  EXPECT_LT(finest.segment<3>(kPosition).norm(), 1e-5);
  // Velocity: rates that change otherwise than linearly within two samples, 6e-9 m/s.
  EXPECT_LT(finest.segment<3>(kVelocity).norm(), 1e-8);
  EXPECT_LT(finest.segment<3>(kAttitude).norm(), 1e-8);
  const double order =
      std::log2(coarse.segment<3>(kPosition).norm() / fine.segment<3>(kPosition).norm());
  EXPECT_NEAR(order, 2, 0.1);
  const double attitude_order =
      std::log2(coarse.segment<3>(kAttitude).norm() / fine.segment<3>(kAttitude).norm());
  EXPECT_NEAR(attitude_order, 3, 0.1);  // (15) with the previous sample
}

TEST(Motion, WithoutTheEarthTheSameTestFails) {
  const ClosedFormMotion motion(wuhan_earth());
  EarthModel still = wuhan_earth();
  still.omega_ie_w.setZero();
  const Vector15d error = prediction_error(motion, still, 2, 3, 200);
  EXPECT_NEAR(error.segment<3>(kAttitude).norm(), 7.292e-5, 1e-7);  // 15 deg/h for one second
  // Of the order of 2 w v T = 1.8 mm/s and half of it in position: a hundred times the bounds
  // above.
  EXPECT_GT(error.segment<3>(kVelocity).norm(), 3e-4);
  EXPECT_GT(error.segment<3>(kPosition).norm(), 1e-4);
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
  const Vector15d error = prediction_error(motion, steep_earth(), 2, 2.2, 200);
  // Gravity follows the way within the interval, as it would be without the change of gravity:
  // left is G^2 v T^4 / 24 = 1.8e-7 m/s.
  EXPECT_LT(error.segment<3>(kVelocity).norm(), 3e-7);
  EarthModel constant = steep_earth();
  constant.g_w = steep_earth().gravity(motion.p(2));
  constant.gravity_gradient.setZero();
  const Vector15d without = prediction_error(motion, constant, 2, 2.2, 200);
  EXPECT_GT(without.segment<3>(kVelocity).norm(), 1e-3);  // G v T^2 / 2
}

TEST(Motion, RestOnTheEarthStaysAtRest) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion rest(earth, 0);
  const Vector15d error = prediction_error(rest, earth, 0, 60, 200);
  // To first order in w T the velocity would be wrong by w^2 g T^3 / 6, 1.9 mm/s, after a minute.
  // What is left is the end of the series, (w T)^4 g T / 120.
  EXPECT_LT(error.segment<3>(kVelocity).norm(), 2e-9);
  EXPECT_LT(error.segment<3>(kPosition).norm(), 1e-7);
  EXPECT_LT(error.segment<3>(kAttitude).norm(), 1e-12);
}

/// Section III to the letter: (13), (16)-(20) and (21)-(29), attitude used while integrating,
/// positions summed for (29).
struct PaperIntegral {
  Vector3d dv = Vector3d::Zero(), dp = Vector3d::Zero(), cor_p = Vector3d::Zero();
};

PaperIntegral integrate_as_printed(const std::vector<ImuIncrement>& increments, const NodeState& x0,
                                   const EarthModel& earth) {
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
        velocity_with_sculling(before.dtheta_b, before.dvel_b, now.dtheta_b, now.dvel_b);
    const Matrix3d turn = so3::exp(-earth.omega_ie_w * (t + dt / 2)).toRotationMatrix();
    const Vector3d y = R0.transpose() * turn * R0 * (q * u);
    out.dp += dt * (out.dv + y / 2);
    out.dv += y;
    const Vector3d v_next = v + R0 * y + dt * (earth.g_w - 2 * earth.omega_ie_w.cross(v));
    const Vector3d p_next = p + dt / 2 * (v + v_next);
    out.cor_p += 2 * earth.omega_ie_w.cross(dt / 2 * (p + p_next));
    p = p_next;
    v = v_next;
    q = q * so3::exp(rotation_with_coning(before.dtheta_b, now.dtheta_b));
    t += dt;
  }
  return out;
}

TEST(Motion, EqualsThePaperAsPrinted) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const std::vector<ImuIncrement> increments = motion.increments(2, 3, 200);
  const Preintegration pre = preintegrate(increments);
  const NodeState x0 = motion.state(2);
  const NodeState x1 = predict(x0, pre, earth);
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

NodeState random_state(std::mt19937& rng, double rotation) {
  std::uniform_real_distribution<double> u(-1, 1);
  const auto draw = [&](double scale) {
    return Vector3d(scale * Vector3d(u(rng), u(rng), u(rng)));
  };
  NodeState x;
  x.p_w_b = draw(100);
  x.v_w_b = draw(20);
  x.q_w_b = so3::exp(draw(rotation));
  x.bias.gyro = draw(0.01);
  x.bias.accel = draw(0.1);
  return x;
}

Matrix15d numerical_jacobian(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                             const EarthModel& earth, bool by_x0) {
  Matrix15d J;
  for (int i = 0; i < 15; ++i) {
    const Vector15d d = 1e-6 * Vector15d::Unit(i);
    const auto at = [&](const Vector15d& step) {
      return by_x0 ? motion_residual_value(boxplus(x0, step), x1, pre, earth)
                   : motion_residual_value(x0, boxplus(x1, step), pre, earth);
    };
    J.col(i) = (at(d) - at(-d)) / 2e-6;
  }
  return J;
}

TEST(Motion, JacobiansAreDerivatives) {
  // An Earth that turns a thousand times faster, so that its terms do not hide in rounding.
  EarthModel earth = steep_earth();
  earth.omega_ie_w *= 1000;
  const ClosedFormMotion motion(earth);
  Preintegration pre = preintegrate(motion.increments(2, 3, 100));
  pre.gyro_bias_decay = 0.8;
  pre.accel_bias_decay = 0.7;
  std::mt19937 rng{7};
  for (const double rotation : {0.0, 1e-9, 0.5, 1.7}) {
    const NodeState x0 = random_state(rng, rotation);
    const NodeState x1 = random_state(rng, rotation);
    const MotionResidual m = motion_residual(x0, x1, pre, earth);
    const Matrix15d J0 = numerical_jacobian(x0, x1, pre, earth, true);
    const Matrix15d J1 = numerical_jacobian(x0, x1, pre, earth, false);
    // Central differences: rounding of 1e2 m * 1e-16 / 1e-6 and third derivatives * 1e-12.
    EXPECT_LT((m.J_x0 - J0).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    EXPECT_LT((m.J_x1 - J1).cwiseAbs().maxCoeff(), 2e-7) << "rotation " << rotation;
    EXPECT_EQ(m.r, motion_residual_value(x0, x1, pre, earth));
  }
}

TEST(Motion, PredictionHasNoResidual) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  const Preintegration pre = preintegrate(motion.increments(2, 3, 100));
  std::mt19937 rng{11};
  const NodeState x0 = random_state(rng, 1);
  const Vector15d r = motion_residual_value(x0, predict(x0, pre, earth), pre, earth);
  EXPECT_LT(r.norm(), 1e-12);
}

TEST(Motion, PredictedCovarianceIsThatOfPerturbedPredictions) {
  const EarthModel earth = wuhan_earth();
  const ClosedFormMotion motion(earth);
  Preintegration pre = preintegrate(motion.increments(2, 3, 100));
  pre.covariance.setZero();
  const NodeState x0 = motion.state(2);
  const NodeState x1 = predict(x0, pre, earth);
  Matrix15d F;
  for (int i = 0; i < 15; ++i) {
    const Vector15d d = 1e-6 * Vector15d::Unit(i);
    F.col(i) = (boxminus(predict(boxplus(x0, d), pre, earth), x1) -
                boxminus(predict(boxplus(x0, -d), pre, earth), x1)) /
               2e-6;
  }
  Matrix15d P = Matrix15d::Identity();
  P(2, 7) = P(7, 2) = 0.3;
  const Matrix15d expected = F * P * F.transpose();
  EXPECT_LT((predict_covariance(x0, x1, pre, earth, P) - expected).cwiseAbs().maxCoeff(),
            1e-6 * expected.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace foucault
