#include "foucault/preintegration/motion.h"

#include <Eigen/LU>
#include <cmath>

#include "foucault/core/so3.h"

namespace foucault::preintegration {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using namespace state::block;

/// The preintegration at the biases of a node and at scale factors, (46).
struct Corrected {
  Vector3d dp, dv;
  Quaterniond dq;
  Vector3d dq_shift;
};

Corrected correct(const MotionDeltas& pre, const state::ImuBias& bias,
                  const state::ImuScale& scale) {
  const Vector3d dg = bias.gyro - pre.bias.gyro;
  const Vector3d da = bias.accel - pre.bias.accel;
  Vector3d dp = pre.dp + pre.by_gyro_bias.dp * dg + pre.by_accel_bias.dp * da;
  Vector3d dv = pre.dv + pre.by_gyro_bias.dv * dg + pre.by_accel_bias.dv * da;
  Vector3d shift = pre.by_gyro_bias.dq * dg;
  if (pre.scale) {
    const Vector3d sg = scale.gyro - pre.scale->gyro;
    const Vector3d sa = scale.accel - pre.scale->accel;
    const Eigen::Matrix<double, 6, 1> cg = scale.gyro_cross - pre.scale->gyro_cross;
    const Vector3d ca = scale.accel_cross - pre.scale->accel_cross;
    dp += pre.by_gyro_scale.dp * sg + pre.by_accel_scale.dp * sa + pre.by_accel_cross.dp * ca;
    dv += pre.by_gyro_scale.dv * sg + pre.by_accel_scale.dv * sa + pre.by_accel_cross.dv * ca;
    shift += pre.by_gyro_scale.dq * sg;
    for (std::size_t i = 0; i < pre.by_gyro_cross.size(); ++i) {
      const Vector3d c = cg.segment<3>(3 * static_cast<Eigen::Index>(i));
      dp += pre.by_gyro_cross[i].dp * c;
      dv += pre.by_gyro_cross[i].dv * c;
      shift += pre.by_gyro_cross[i].dq * c;
    }
  }
  return {dp, dv, pre.dq * so3::exp(shift), shift};
}

/// A bias of b0 at the beginning decays towards the one at which the interval was integrated.
state::ImuBias expected_bias(const state::ImuBias& b0, const MotionDeltas& pre) {
  state::ImuBias b1;
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
  Fall(const state::NodeState& x0, const EarthModel& earth, double T) {
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
  state::NodeVector r;
};

Terms evaluate(const state::NodeState& x0, const state::NodeState& x1, const MotionDeltas& pre,
               const EarthModel& earth, const state::ImuScale& scale) {
  const Vector3d& w = earth.omega_ie_w;
  const Quaterniond earth_turn = so3::exp(w * pre.dt);
  const Matrix3d R0 = x0.q_w_b.toRotationMatrix();
  Terms t{
      correct(pre, x0.bias, scale), R0.transpose(), {}, Fall(x0, earth, pre.dt), {}, {}, {}, {}};
  t.turn = t.R0t * earth_turn.toRotationMatrix();

  const Vector3d moved = x1.p_w_b - x0.p_w_b;
  t.p_seen = t.turn * moved - t.R0t * t.fall.way;
  t.v_seen = t.turn * (x1.v_w_b + w.cross(moved)) - t.R0t * t.fall.velocity;
  t.q_seen = x0.q_w_b.conjugate() * earth_turn * x1.q_w_b;

  state::part(t.r, position) = t.p_seen - t.R0t * (t.fall.gradient * (R0 * pre.iidp)) - t.z.dp;
  state::part(t.r, velocity) = t.v_seen - t.R0t * (t.fall.gradient * (R0 * pre.idp)) - t.z.dv;
  state::part(t.r, attitude) = so3::log(t.z.dq.conjugate() * t.q_seen);
  const state::ImuBias expected = expected_bias(x0.bias, pre);
  state::part(t.r, gyro_bias) = x1.bias.gyro - expected.gyro;
  state::part(t.r, accel_bias) = x1.bias.accel - expected.accel;
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

/// Derivatives of r_q.
struct AttitudeJacobians {
  Matrix3d by_x1;     ///< by dtheta1
  Matrix3d by_shift;  ///< by the correction of dq
};

AttitudeJacobians attitude_jacobians(const Terms& t) {
  const Vector3d r_q = state::part(t.r, attitude);
  const Matrix3d Jr_inverse = so3::right_jacobian_inverse(r_q);
  return {Jr_inverse, -Jr_inverse * so3::exp(r_q).toRotationMatrix().transpose() *
                          so3::right_jacobian(t.z.dq_shift)};
}

state::NodeMatrix jacobian_x0(const Terms& t, const AttitudeJacobians& r_q, const MotionDeltas& pre,
                              const EarthModel& earth) {
  const double T = pre.dt;
  const Matrix3d turn_W = t.turn * so3::skew(earth.omega_ie_w);
  const Matrix3d R0t_G = t.R0t * t.fall.gradient;
  const Matrix3d gradient_b = R0t_G * t.R0t.transpose();
  const FallByPosition fall = fall_by_position(t.fall, earth, T);
  state::NodeMatrix J = state::NodeMatrix::Zero();

  state::part(J, position, position) = -t.turn - t.R0t * fall.way;
  state::part(J, position, velocity) = -T * t.R0t - T * T * T / 6 * R0t_G;
  state::part(J, position, attitude) =
      so3::skew(t.p_seen) - conjugation_jacobian(gradient_b, pre.iidp);
  state::part(J, position, gyro_bias) = -pre.by_gyro_bias.dp;
  state::part(J, position, accel_bias) = -pre.by_accel_bias.dp;

  state::part(J, velocity, position) = -turn_W - t.R0t * fall.velocity;
  state::part(J, velocity, velocity) = -t.R0t - T * T / 2 * R0t_G;
  state::part(J, velocity, attitude) =
      so3::skew(t.v_seen) - conjugation_jacobian(gradient_b, pre.idp);
  state::part(J, velocity, gyro_bias) = -pre.by_gyro_bias.dv;
  state::part(J, velocity, accel_bias) = -pre.by_accel_bias.dv;

  state::part(J, attitude, attitude) = -r_q.by_x1 * t.q_seen.toRotationMatrix().transpose();
  state::part(J, attitude, gyro_bias) = r_q.by_shift * pre.by_gyro_bias.dq;

  state::part(J, gyro_bias, gyro_bias) = -pre.gyro_bias_decay * Matrix3d::Identity();
  state::part(J, accel_bias, accel_bias) = -pre.accel_bias_decay * Matrix3d::Identity();
  return J;
}

state::NodeMatrix jacobian_x1(const Terms& t, const AttitudeJacobians& r_q,
                              const EarthModel& earth) {
  state::NodeMatrix J = state::NodeMatrix::Zero();
  state::part(J, position, position) = t.turn;
  state::part(J, velocity, position) = t.turn * so3::skew(earth.omega_ie_w);
  state::part(J, velocity, velocity) = t.turn;
  state::part(J, attitude, attitude) = r_q.by_x1;
  state::part(J, gyro_bias, gyro_bias) = Matrix3d::Identity();
  state::part(J, accel_bias, accel_bias) = Matrix3d::Identity();
  return J;
}

NodeByAxis jacobian_of(const DeltaJacobian& change, const AttitudeJacobians& r_q) {
  NodeByAxis J = NodeByAxis::Zero();
  state::rows_of(J, position) = -change.dp;
  state::rows_of(J, velocity) = -change.dv;
  state::rows_of(J, attitude) = r_q.by_shift * change.dq;
  return J;
}

}  // namespace

MotionResidual motion_residual(const state::NodeState& x0, const state::NodeState& x1,
                               const MotionDeltas& pre, const EarthModel& earth,
                               const state::ImuScale& scale) {
  const Terms t = evaluate(x0, x1, pre, earth, scale);
  const AttitudeJacobians r_q = attitude_jacobians(t);
  MotionResidual m{t.r, jacobian_x0(t, r_q, pre, earth), jacobian_x1(t, r_q, earth)};
  if (pre.scale) {
    m.J_gyro_scale = jacobian_of(pre.by_gyro_scale, r_q);
    m.J_accel_scale = jacobian_of(pre.by_accel_scale, r_q);
    for (std::size_t i = 0; i < m.J_gyro_cross.size(); ++i)
      m.J_gyro_cross[i] = jacobian_of(pre.by_gyro_cross[i], r_q);
    m.J_accel_cross = jacobian_of(pre.by_accel_cross, r_q);
  }
  return m;
}

state::NodeVector motion_residual_value(const state::NodeState& x0, const state::NodeState& x1,
                                        const MotionDeltas& pre, const EarthModel& earth,
                                        const state::ImuScale& scale) {
  return evaluate(x0, x1, pre, earth, scale).r;
}

state::NodeBySlow slow_jacobian(const MotionResidual& m, const state::Layout& layout) {
  state::NodeBySlow J = state::NodeBySlow::Zero(m.r.size(), layout.slow_size());
  if (const state::SlowBlock* gyro = layout.find(gyro_scale))
    J.middleCols<3>(gyro->index) = m.J_gyro_scale;
  if (const state::SlowBlock* accel = layout.find(accel_scale))
    J.middleCols<3>(accel->index) = m.J_accel_scale;
  if (const state::SlowBlock* gyro = layout.find(gyro_cross_axis))
    J.middleCols(gyro->index, gyro->block.size) << m.J_gyro_cross[0], m.J_gyro_cross[1];
  if (const state::SlowBlock* accel = layout.find(accel_cross_axis))
    J.middleCols<3>(accel->index) = m.J_accel_cross;
  return J;
}

state::NodeState predict(const state::NodeState& x0, const MotionDeltas& pre,
                         const EarthModel& earth, const state::ImuScale& scale) {
  const Vector3d& w = earth.omega_ie_w;
  const Corrected z = correct(pre, x0.bias, scale);
  const Matrix3d R0 = x0.q_w_b.toRotationMatrix();
  const Fall fall(x0, earth, pre.dt);
  const Vector3d way = fall.way + R0 * z.dp + fall.gradient * (R0 * pre.iidp);
  const Vector3d velocity = fall.velocity + R0 * z.dv + fall.gradient * (R0 * pre.idp);
  const Quaterniond back = so3::exp(-w * pre.dt);

  state::NodeState x1;
  const Vector3d moved = back * way;
  x1.p_w_b = x0.p_w_b + moved;
  x1.v_w_b = back * velocity - w.cross(moved);
  x1.q_w_b = (back * x0.q_w_b * z.dq).normalized();
  x1.bias = expected_bias(x0.bias, pre);
  return x1;
}

/// r(x0, x1, slow) = e to first order, solved for d1: d1 = T (d0, d_slow) + J1^-1 e.
state::StateMatrix predict_covariance(const state::NodeState& x0, const state::NodeState& x1,
                                      const Preintegration& pre, const EarthModel& earth,
                                      const state::StateMatrix& covariance_x0,
                                      const state::Layout& layout, const state::SlowVector& slow) {
  const MotionResidual m = motion_residual(x0, x1, pre, earth, layout.imu_scale(slow));
  const Eigen::PartialPivLU<state::NodeMatrix> J1(
      m.J_x1);  // block lower triangular, invertible blocks
  state::NodeByState T(m.r.size(), layout.size());
  T << J1.solve(-m.J_x0), J1.solve(-slow_jacobian(m, layout));
  const state::NodeMatrix B = J1.solve(state::NodeMatrix::Identity());
  const state::NodeByState carried = T * covariance_x0;
  state::StateMatrix P = covariance_x0;
  state::node_part(P) = carried * T.transpose() + B * pre.covariance * B.transpose();
  state::node_by_slow(P) = carried.rightCols(layout.slow_size());
  state::slow_by_node(P) = state::node_by_slow(P).transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace foucault::preintegration
