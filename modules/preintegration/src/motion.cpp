#include "foucault/preintegration/motion.h"

#include <Eigen/LU>

#include "foucault/core/so3.h"

namespace foucault {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace error_state;

/// The preintegration at the biases of a node, (46).
struct Corrected {
  Vector3d dp, dv;
  Quaterniond dq;
  Vector3d dq_shift;  ///< J_dq_bg d_g
};

Corrected correct(const Preintegration& pre, const ImuBias& bias) {
  const Vector3d dg = bias.gyro - pre.bias.gyro;
  const Vector3d da = bias.accel - pre.bias.accel;
  const Vector3d shift = pre.by_gyro_bias.dq * dg;
  return {pre.dp + pre.by_gyro_bias.dp * dg + pre.by_accel_bias.dp * da,
          pre.dv + pre.by_gyro_bias.dv * dg + pre.by_accel_bias.dv * da, pre.dq * so3::exp(shift),
          shift};
}

/// A bias of b0 at the beginning decays towards the one at which the interval was integrated.
ImuBias expected_bias(const ImuBias& b0, const Preintegration& pre) {
  ImuBias b1;
  b1.gyro = pre.bias.gyro + pre.gyro_bias_decay * (b0.gyro - pre.bias.gyro);
  b1.accel = pre.bias.accel + pre.accel_bias_decay * (b0.accel - pre.bias.accel);
  return b1;
}

/// n-th integral over T of Exp(w t) g, T^n sum (w T x)^k g / (k + n)!. Four terms: the next is
/// (w T)^4 / 120 of the whole or less, (w T)^4 being 4e-10 for 60 s.
template <int n>
Vector3d turned_integral(const Vector3d& w, double T, const Vector3d& g) {
  constexpr double kFactorial = n == 1 ? 1 : n == 2 ? 2 : n == 3 ? 6 : 24;
  const Vector3d turn = w * T;
  const Vector3d sum =
      g + turn.cross(g + turn.cross(g + turn.cross(g) / (n + 3)) / (n + 2)) / (n + 1);
  double power = 1;
  for (int i = 0; i < n; ++i) power *= T;
  return power / kFactorial * sum;
}

/// The motion over T seen from inertial space, without what the IMU measured. See motion.h.
struct Fall {
  Vector3d g0;
  Matrix3d gradient;  ///< G' = G + [w x]^2
  Vector3d way;       ///< v0 T + S2 g0 + G' (v0 T^3/6 + g0 T^4/24)
  Vector3d velocity;  ///< its derivative
  Fall(const NodeState& x0, const EarthModel& earth, double T) {
    const Vector3d& w = earth.omega_ie_w;
    const Vector3d& v0 = x0.v_w_b;
    g0 = earth.gravity(x0.p_w_b);
    gradient = earth.gravity_gradient + w * w.transpose();
    gradient.diagonal().array() -= w.squaredNorm();
    way = T * v0 + turned_integral<2>(w, T, g0) +
          gradient * (T * T * T / 6 * v0 + turned_integral<4>(w, T, g0));
    velocity = v0 + turned_integral<1>(w, T, g0) +
               gradient * (T * T / 2 * v0 + turned_integral<3>(w, T, g0));
  }
};

/// All that residual and Jacobians share.
struct Terms {
  Corrected z;
  Matrix3d R0t;
  Matrix3d turn;  ///< R0^T Exp(w T)
  Fall fall;
  Vector3d p_seen;     ///< R0^T (s(T) - way)
  Vector3d v_seen;     ///< R0^T (s'(T) - velocity)
  Quaterniond q_seen;  ///< q0^-1 Exp(w T) q1
  Vector15d r;
};

Terms evaluate(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
               const EarthModel& earth) {
  const Vector3d& w = earth.omega_ie_w;
  const Quaterniond earth_turn = so3::exp(w * pre.dt);
  const Matrix3d R0 = x0.q_w_b.toRotationMatrix();
  Terms t{correct(pre, x0.bias), R0.transpose(), {}, Fall(x0, earth, pre.dt), {}, {}, {}, {}};
  t.turn = t.R0t * earth_turn.toRotationMatrix();

  const Vector3d moved = x1.p_w_b - x0.p_w_b;
  t.p_seen = t.turn * moved - t.R0t * t.fall.way;
  t.v_seen = t.turn * (x1.v_w_b + w.cross(moved)) - t.R0t * t.fall.velocity;
  t.q_seen = x0.q_w_b.conjugate() * earth_turn * x1.q_w_b;

  t.r.segment<3>(kPosition) = t.p_seen - t.R0t * (t.fall.gradient * (R0 * pre.iidp)) - t.z.dp;
  t.r.segment<3>(kVelocity) = t.v_seen - t.R0t * (t.fall.gradient * (R0 * pre.idp)) - t.z.dv;
  t.r.segment<3>(kAttitude) = so3::log(t.z.dq.conjugate() * t.q_seen);
  const ImuBias expected = expected_bias(x0.bias, pre);
  t.r.segment<3>(kGyroBias) = x1.bias.gyro - expected.gyro;
  t.r.segment<3>(kAccelBias) = x1.bias.accel - expected.accel;
  return t;
}

/// Derivatives of way and velocity by p0, as far as g0 changes with it.
struct FallByPosition {
  Matrix3d way, velocity;
};

FallByPosition fall_by_position(const Fall& fall, const EarthModel& earth, double T) {
  const Vector3d& w = earth.omega_ie_w;
  FallByPosition d;
  for (int i = 0; i < 3; ++i) {
    const Vector3d g = earth.gravity_gradient.col(i);
    d.way.col(i) = turned_integral<2>(w, T, g) + fall.gradient * turned_integral<4>(w, T, g);
    d.velocity.col(i) = turned_integral<1>(w, T, g) + fall.gradient * turned_integral<3>(w, T, g);
  }
  return d;
}

/// d (R0^T M R0 x) / d dtheta0.
Matrix3d conjugation_jacobian(const Matrix3d& R0t_M_R0, const Vector3d& x) {
  return so3::skew(R0t_M_R0 * x) - R0t_M_R0 * so3::skew(x);
}

void set_block(Matrix15d& J, int row, int column, const Matrix3d& block) {
  J.block<3, 3>(row, column) = block;
}

Matrix15d jacobian_x0(const Terms& t, const Preintegration& pre, const EarthModel& earth) {
  const double T = pre.dt;
  const Matrix3d turn_W = t.turn * so3::skew(earth.omega_ie_w);
  const Matrix3d R0t_G = t.R0t * t.fall.gradient;
  const Matrix3d gradient_b = R0t_G * t.R0t.transpose();
  const FallByPosition fall = fall_by_position(t.fall, earth, T);
  const Vector3d r_q = t.r.segment<3>(kAttitude);
  const Matrix3d Jr_inverse = so3::right_jacobian_inverse(r_q);
  Matrix15d J = Matrix15d::Zero();

  set_block(J, kPosition, kPosition, -t.turn - t.R0t * fall.way);
  set_block(J, kPosition, kVelocity, -T * t.R0t - T * T * T / 6 * R0t_G);
  set_block(J, kPosition, kAttitude,
            so3::skew(t.p_seen) - conjugation_jacobian(gradient_b, pre.iidp));
  set_block(J, kPosition, kGyroBias, -pre.by_gyro_bias.dp);
  set_block(J, kPosition, kAccelBias, -pre.by_accel_bias.dp);

  set_block(J, kVelocity, kPosition, -turn_W - t.R0t * fall.velocity);
  set_block(J, kVelocity, kVelocity, -t.R0t - T * T / 2 * R0t_G);
  set_block(J, kVelocity, kAttitude,
            so3::skew(t.v_seen) - conjugation_jacobian(gradient_b, pre.idp));
  set_block(J, kVelocity, kGyroBias, -pre.by_gyro_bias.dv);
  set_block(J, kVelocity, kAccelBias, -pre.by_accel_bias.dv);

  set_block(J, kAttitude, kAttitude, -Jr_inverse * t.q_seen.toRotationMatrix().transpose());
  set_block(J, kAttitude, kGyroBias,
            -Jr_inverse * so3::exp(r_q).toRotationMatrix().transpose() *
                so3::right_jacobian(t.z.dq_shift) * pre.by_gyro_bias.dq);

  set_block(J, kGyroBias, kGyroBias, -pre.gyro_bias_decay * Matrix3d::Identity());
  set_block(J, kAccelBias, kAccelBias, -pre.accel_bias_decay * Matrix3d::Identity());
  return J;
}

Matrix15d jacobian_x1(const Terms& t, const EarthModel& earth) {
  Matrix15d J = Matrix15d::Zero();
  set_block(J, kPosition, kPosition, t.turn);
  set_block(J, kVelocity, kPosition, t.turn * so3::skew(earth.omega_ie_w));
  set_block(J, kVelocity, kVelocity, t.turn);
  set_block(J, kAttitude, kAttitude, so3::right_jacobian_inverse(t.r.segment<3>(kAttitude)));
  set_block(J, kGyroBias, kGyroBias, Matrix3d::Identity());
  set_block(J, kAccelBias, kAccelBias, Matrix3d::Identity());
  return J;
}

}  // namespace

MotionResidual motion_residual(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                               const EarthModel& earth) {
  const Terms t = evaluate(x0, x1, pre, earth);
  return {t.r, jacobian_x0(t, pre, earth), jacobian_x1(t, earth)};
}

Vector15d motion_residual_value(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                                const EarthModel& earth) {
  return evaluate(x0, x1, pre, earth).r;
}

NodeState predict(const NodeState& x0, const Preintegration& pre, const EarthModel& earth) {
  const Vector3d& w = earth.omega_ie_w;
  const Corrected z = correct(pre, x0.bias);
  const Matrix3d R0 = x0.q_w_b.toRotationMatrix();
  const Fall fall(x0, earth, pre.dt);
  const Vector3d way = fall.way + R0 * z.dp + fall.gradient * (R0 * pre.iidp);
  const Vector3d velocity = fall.velocity + R0 * z.dv + fall.gradient * (R0 * pre.idp);
  const Quaterniond back = so3::exp(-w * pre.dt);

  NodeState x1;
  const Vector3d moved = back * way;
  x1.p_w_b = x0.p_w_b + moved;
  x1.v_w_b = back * velocity - w.cross(moved);
  x1.q_w_b = (back * x0.q_w_b * z.dq).normalized();
  x1.bias = expected_bias(x0.bias, pre);
  return x1;
}

Matrix15d predict_covariance(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                             const EarthModel& earth, const Matrix15d& covariance_x0) {
  // r(x0, x1) = e: J1 d1 = e - J0 d0. J1 is block lower triangular with invertible blocks.
  const MotionResidual m = motion_residual(x0, x1, pre, earth);
  const Eigen::PartialPivLU<Matrix15d> J1(m.J_x1);
  const Matrix15d F = J1.solve(m.J_x0);
  const Matrix15d B = J1.solve(Matrix15d::Identity());
  const Matrix15d P = F * covariance_x0 * F.transpose() + B * pre.covariance * B.transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace foucault
