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
  const Vector3d shift = pre.J_dq_bg * dg;
  return {pre.dp + pre.J_dp_bg * dg + pre.J_dp_ba * da,
          pre.dv + pre.J_dv_bg * dg + pre.J_dv_ba * da, pre.dq * so3::exp(shift), shift};
}

/// What gravity does over T: velocity, position and the integral of position. Along the interval it
/// changes by its gradient times the way, G v0 t.
struct Fall {
  Vector3d v, p, ip;
  Fall(const NodeState& x0, const EarthModel& earth, double T) {
    const Vector3d g = earth.gravity(x0.p_w_b);
    const Vector3d g_dot = earth.gravity_gradient * x0.v_w_b;
    v = T * g + T * T / 2 * g_dot;
    p = T * T / 2 * g + T * T * T / 6 * g_dot;
    ip = T * T * T / 6 * g;
  }
};

/// All that residual and Jacobians share.
struct Terms {
  Corrected z;
  Matrix3d R0t;
  Vector3d a;          ///< Earth rate in b(t_{k-1})
  Vector3d dv_shift;   ///< T dv - dp
  Vector3d dp_shift;   ///< T dp - 2 idp
  Vector3d p_seen;     ///< position row of (28) in b(t_{k-1})
  Vector3d v_seen;     ///< velocity row of (25)
  Quaterniond q_seen;  ///< (exp(-w T) q0)^-1 q1
  Vector15d r;
};

Terms evaluate(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
               const EarthModel& earth) {
  const double T = pre.dt;
  const Vector3d& w = earth.omega_ie_w;
  Terms t;
  t.z = correct(pre, x0.bias);
  t.R0t = x0.q_w_b.toRotationMatrix().transpose();
  t.a = t.R0t * w;
  t.dv_shift = T * t.z.dv - t.z.dp;
  t.dp_shift = T * t.z.dp - 2 * pre.idp;

  const Vector3d moved = x1.p_w_b - x0.p_w_b;
  const Fall fall(x0, earth, T);
  const Vector3d integral_moved = T * T / 2 * x0.v_w_b + fall.ip + t.R0t.transpose() * pre.idp;
  t.p_seen = t.R0t * (moved - T * x0.v_w_b - fall.p + 2 * w.cross(integral_moved));
  t.v_seen = t.R0t * (x1.v_w_b - x0.v_w_b - fall.v + 2 * w.cross(moved));
  t.q_seen = x0.q_w_b.conjugate() * so3::exp(w * T) * x1.q_w_b;

  t.r.segment<3>(kPosition) = t.p_seen - (t.z.dp - t.a.cross(t.dp_shift));
  t.r.segment<3>(kVelocity) = t.v_seen - (t.z.dv - t.a.cross(t.dv_shift));
  t.r.segment<3>(kAttitude) = so3::log(t.z.dq.conjugate() * t.q_seen);
  t.r.segment<3>(kGyroBias) = x1.bias.gyro - x0.bias.gyro;
  t.r.segment<3>(kAccelBias) = x1.bias.accel - x0.bias.accel;
  return t;
}

void set_block(Matrix15d& J, int row, int column, const Matrix3d& block) {
  J.block<3, 3>(row, column) = block;
}

Matrix15d jacobian_x0(const Terms& t, const Preintegration& pre, const EarthModel& earth) {
  const double T = pre.dt;
  const Matrix3d A = so3::skew(t.a);
  const Matrix3d R0t_W = A * t.R0t;  // R0^T [w x] = [a x] R0^T
  const Matrix3d I_TA = Matrix3d::Identity() - T * A;
  const Vector3d r_q = t.r.segment<3>(kAttitude);
  const Matrix3d Jr_inverse = so3::right_jacobian_inverse(r_q);
  Matrix15d J = Matrix15d::Zero();

  const Matrix3d R0t_G = t.R0t * earth.gravity_gradient;
  const Matrix3d W_G = A * R0t_G;  // gravity in the Coriolis integral

  set_block(J, kPosition, kPosition, -t.R0t - T * T / 2 * R0t_G + T * T * T / 3 * W_G);
  set_block(J, kPosition, kVelocity, T * (T * R0t_W - t.R0t - T * T / 6 * R0t_G));
  set_block(J, kPosition, kAttitude,
            so3::skew(t.p_seen) - 2 * A * so3::skew(pre.idp) - so3::skew(t.dp_shift) * A);
  set_block(J, kPosition, kGyroBias, -I_TA * pre.J_dp_bg);
  set_block(J, kPosition, kAccelBias, -I_TA * pre.J_dp_ba);

  set_block(J, kVelocity, kPosition, -2 * R0t_W - T * R0t_G);
  set_block(J, kVelocity, kVelocity, -t.R0t - T * T / 2 * R0t_G);
  set_block(J, kVelocity, kAttitude, so3::skew(t.v_seen) - so3::skew(t.dv_shift) * A);
  set_block(J, kVelocity, kGyroBias, -I_TA * pre.J_dv_bg - A * pre.J_dp_bg);
  set_block(J, kVelocity, kAccelBias, -I_TA * pre.J_dv_ba - A * pre.J_dp_ba);

  set_block(J, kAttitude, kAttitude, -Jr_inverse * t.q_seen.toRotationMatrix().transpose());
  set_block(J, kAttitude, kGyroBias,
            -Jr_inverse * so3::exp(r_q).toRotationMatrix().transpose() *
                so3::right_jacobian(t.z.dq_shift) * pre.J_dq_bg);

  set_block(J, kGyroBias, kGyroBias, -Matrix3d::Identity());
  set_block(J, kAccelBias, kAccelBias, -Matrix3d::Identity());
  return J;
}

Matrix15d jacobian_x1(const Terms& t) {
  Matrix15d J = Matrix15d::Zero();
  set_block(J, kPosition, kPosition, t.R0t);
  set_block(J, kVelocity, kPosition, 2 * so3::skew(t.a) * t.R0t);
  set_block(J, kVelocity, kVelocity, t.R0t);
  set_block(J, kAttitude, kAttitude, so3::right_jacobian_inverse(t.r.segment<3>(kAttitude)));
  set_block(J, kGyroBias, kGyroBias, Matrix3d::Identity());
  set_block(J, kAccelBias, kAccelBias, Matrix3d::Identity());
  return J;
}

}  // namespace

NodeState boxplus(const NodeState& x, const Vector15d& d) {
  NodeState y;
  y.p_w_b = x.p_w_b + d.segment<3>(kPosition);
  y.v_w_b = x.v_w_b + d.segment<3>(kVelocity);
  y.q_w_b = (x.q_w_b * so3::exp(d.segment<3>(kAttitude))).normalized();
  y.bias.gyro = x.bias.gyro + d.segment<3>(kGyroBias);
  y.bias.accel = x.bias.accel + d.segment<3>(kAccelBias);
  return y;
}

Vector15d boxminus(const NodeState& y, const NodeState& x) {
  Vector15d d;
  d.segment<3>(kPosition) = y.p_w_b - x.p_w_b;
  d.segment<3>(kVelocity) = y.v_w_b - x.v_w_b;
  d.segment<3>(kAttitude) = so3::log(x.q_w_b.conjugate() * y.q_w_b);
  d.segment<3>(kGyroBias) = y.bias.gyro - x.bias.gyro;
  d.segment<3>(kAccelBias) = y.bias.accel - x.bias.accel;
  return d;
}

MotionResidual motion_residual(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                               const EarthModel& earth) {
  const Terms t = evaluate(x0, x1, pre, earth);
  return {t.r, jacobian_x0(t, pre, earth), jacobian_x1(t)};
}

Vector15d motion_residual_value(const NodeState& x0, const NodeState& x1, const Preintegration& pre,
                                const EarthModel& earth) {
  return evaluate(x0, x1, pre, earth).r;
}

NodeState predict(const NodeState& x0, const Preintegration& pre, const EarthModel& earth) {
  const double T = pre.dt;
  const Vector3d& w = earth.omega_ie_w;
  const Corrected z = correct(pre, x0.bias);
  const Vector3d a = x0.q_w_b.conjugate() * w;
  const Vector3d dp = z.dp - a.cross(T * z.dp - 2 * pre.idp);
  const Vector3d dv = z.dv - a.cross(T * z.dv - z.dp);
  const Fall fall(x0, earth, T);
  const Vector3d integral_moved = T * T / 2 * x0.v_w_b + fall.ip + x0.q_w_b * pre.idp;

  NodeState x1;
  const Vector3d moved = T * x0.v_w_b + fall.p + x0.q_w_b * dp - 2 * w.cross(integral_moved);
  x1.p_w_b = x0.p_w_b + moved;
  x1.v_w_b = x0.v_w_b + fall.v + x0.q_w_b * dv - 2 * w.cross(moved);
  x1.q_w_b = (so3::exp(-w * T) * x0.q_w_b * z.dq).normalized();
  x1.bias = x0.bias;
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
