#include "foucault/preintegration/preintegrator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"

namespace foucault::preintegration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// [v x] M.
Matrix3d cross(const Vector3d& v, const Matrix3d& M) {
  Matrix3d out;
  for (int j = 0; j < 3; ++j) out.col(j) = v.cross(M.col(j));
  return out;
}

/// M [v x].
Matrix3d times_cross(const Matrix3d& M, const Vector3d& v) {
  Matrix3d out;
  out.col(0) = v.z() * M.col(1) - v.y() * M.col(2);
  out.col(1) = v.x() * M.col(2) - v.z() * M.col(0);
  out.col(2) = v.y() * M.col(0) - v.x() * M.col(1);
  return out;
}

/// A bias that is constant, or nearly, would leave its rows of the covariance without an inverse.
/// Here it wanders by 1e-5 of its sigma in an hour: a navigation run learns a bias to 1e-3 of it
/// and so gains 1e-4 of its variance. Real ones wander by 1e-2 and more.
double wandering_power(double power, const imu::MarkovBias& bias) {
  constexpr double kLeastWander = 1e-5;
  return std::max(power, kLeastWander * kLeastWander * bias.sigma * bias.sigma / kSecondsPerHour);
}

/// q / |q| for a q that is off by rounding, a Newton step of it.
Eigen::Quaterniond nearly_normalized(const Eigen::Quaterniond& q) {
  return Eigen::Quaterniond(q.coeffs() * (1.5 - 0.5 * q.squaredNorm()));
}

/// A step for a block whose error d turns the sample by -D d, and has turned b by -middle d at its
/// middle: rows of Phi applied to J, see propagate_covariance.
inline void step_of_gyro(const Matrix3d& middle, const Matrix3d& D, const Vector3d& y, double dt,
                         DeltaJacobian& J) {
  const Matrix3d w = cross(y, middle);
  J.dp += dt * (J.dv + 0.5 * w);
  J.dv += w;
  J.dq -= D;
}

/// The same where it changes the velocity by -D d.
inline void step_of_accel(const Matrix3d& D, double dt, DeltaJacobian& J) {
  J.dp += dt * (J.dv - 0.5 * D);
  J.dv -= D;
}

}  // namespace

Preintegrator::Blocks::Blocks() {
  for (Matrix3d* block : {&pp, &pv, &pe, &pg, &pa, &vv, &ve, &vg, &va, &ee, &eg}) block->setZero();
}

Preintegrator::Preintegrator(const imu::ImuNoise& noise, const state::ImuBias& bias,
                             int64_t t_begin_ns, const std::optional<ImuIncrement>& previous,
                             const std::optional<state::ImuScale>& scale)
    : noise_(noise),
      gyro_bias_power_(wandering_power(noise.gyro_bias_power(), imu::gyro_markov_bias(noise))),
      accel_bias_power_(wandering_power(noise.accel_bias_power(), imu::accel_markov_bias(noise))),
      previous_(previous) {
  m_.t_begin_ns = m_.t_end_ns = t_begin_ns;
  m_.bias = bias;
  m_.scale = scale;
  if (!scale) return;
  gyro_gain_ = scale->gyro_gain();
  accel_gain_ = scale->accel_gain();
}

inline Preintegrator::Motion Preintegrator::corrected(const ImuIncrement& increment) const {
  const double dt = increment.dt();
  Motion motion{increment.dtheta_b - m_.bias.gyro * dt, increment.dvel_b - m_.bias.accel * dt};
  if (m_.scale) {
    motion.dtheta = gyro_gain_ * motion.dtheta;
    motion.dvel = accel_gain_ * motion.dvel;
  }
  return motion;
}

void Preintegrator::add(const ImuIncrement& increment) {
  if (increment.t_begin_ns != m_.t_end_ns || increment.t_end_ns <= increment.t_begin_ns)
    throw std::invalid_argument("preintegration: increments must follow each other");
  const double dt = increment.dt();
  const Motion now = corrected(increment);
  Motion before{Vector3d::Zero(), Vector3d::Zero()};
  if (previous_) {
    const double weight = imu::previous_increment_scale(previous_->dt(), dt);
    before = corrected(*previous_);
    before.dtheta *= weight;
    before.dvel *= weight;
  }
  const Vector3d u = imu::velocity_with_sculling(before.dtheta, before.dvel, now.dtheta, now.dvel);
  const Vector3d y = C_ * u;
  m_.dq = nearly_normalized(m_.dq * so3::exp(imu::rotation_with_coning(before.dtheta, now.dtheta)));
  const Matrix3d C_next = m_.dq.toRotationMatrix();

  propagate_errors(increment, now, C_next, y);

  m_.iidp += dt * (m_.idp + dt * (m_.dp / 2 + dt * (m_.dv / 6 + y / 24)));
  m_.idp += dt * (m_.dp + dt * (m_.dv / 2 + y / 6));
  m_.dp += dt * (m_.dv + y / 2);
  m_.dv += y;
  m_.t_end_ns = increment.t_end_ns;
  m_.dt = seconds_between(m_.t_begin_ns, m_.t_end_ns);
  C_ = C_next;
  previous_ = increment;
}

void Preintegrator::propagate_errors(const ImuIncrement& increment, const Motion& motion,
                                     const Matrix3d& C_next, const Vector3d& y) {
  const double dt = increment.dt();
  const Matrix3d D = (0.5 * dt) * (C_ + C_next);
  propagate_covariance(increment, D, y, dt);
  propagate_jacobians(motion, D, y, dt);
}

void Preintegrator::propagate_jacobians(const Motion& motion, const Matrix3d& D, const Vector3d& y,
                                        double dt) {
  if (m_.scale) return propagate_scale_jacobians(motion, D, y, dt);
  step_of_gyro((0.5 * dt) * C_ - m_.by_gyro_bias.dq, D, y, dt, m_.by_gyro_bias);
  step_of_accel(D, dt, m_.by_accel_bias);
}

/// With those by the biases.
void Preintegrator::propagate_scale_jacobians(const Motion& motion, const Matrix3d& D,
                                              const Vector3d& y, double dt) {
  using namespace state::axis_pairs;
  const Matrix3d C_gyro = C_ * gyro_gain_, D_gyro = D * gyro_gain_, D_accel = D * accel_gain_;
  step_of_gyro((0.5 * dt) * C_gyro - m_.by_gyro_bias.dq, D_gyro, y, dt, m_.by_gyro_bias);
  step_of_accel(D_accel, dt, m_.by_accel_bias);
  const Vector3d half = 0.5 * motion.dtheta, rate = motion.dtheta / dt, force = motion.dvel / dt;
  const auto by_gyro = [&](const state::AxisPairs& pairs, DeltaJacobian& J) {
    step_of_gyro(state::by_elements(C_gyro, half, pairs) - J.dq,
                 state::by_elements(D_gyro, rate, pairs), y, dt, J);
  };
  by_gyro(scale, m_.by_gyro_scale);
  for (std::size_t i = 0; i < gyro_cross.size(); ++i) by_gyro(gyro_cross[i], m_.by_gyro_cross[i]);
  step_of_accel(state::by_elements(D_accel, force, scale), dt, m_.by_accel_scale);
  step_of_accel(state::by_elements(D_accel, force, accel_cross), dt, m_.by_accel_cross);
}

/// Half of a sample's noise, W h.
void Preintegrator::add_noise(double h, double q_g, double q_a) {
  cov_.ee.diagonal().array() += h * q_g;
  cov_.vv.diagonal().array() += h * q_a;
  cov_.gg += h * gyro_bias_power_;
  cov_.aa += h * accel_bias_power_;
}

/// Decay of the biases over a sample, kept while samples are equally long.
void Preintegrator::set_bias_decay(double dt) {
  if (dt == bias_decay_dt_) return;
  bias_decay_dt_ = dt;
  gyro_bias_decay_ = std::exp(-dt / imu::gyro_markov_bias(noise_).tau);
  accel_bias_decay_ = std::exp(-dt / imu::accel_markov_bias(noise_).tau);
}

/// Phi of one sample, the exact derivative of add():
///   eps' = eps - D bg
///   v'   = v + w,           w = -[y x] (eps - dt/2 C bg) - D ba
///   p'   = p + dt (v + w/2)
///   bg'  = decay bg,  ba' = decay ba
/// and S' = Phi (S + dt/2 W) Phi^T + dt/2 W, W = diag(0, q_a, q_g, q_bg, q_ba): the trapezoid of
/// (42) with its term of second order, (Phi - I) W (Phi - I)^T dt/2, kept. Without that term a
/// single sample would have a covariance that is not positive. (40), (42), (43)
void Preintegrator::propagate_covariance(const ImuIncrement& increment, const Matrix3d& D,
                                         const Vector3d& y, double dt) {
  set_bias_decay(dt);
  const double q_g = noise_.gyro_noise_density * noise_.gyro_noise_density +
                     increment.extra_gyro_noise_density * increment.extra_gyro_noise_density;
  const double q_a = noise_.accel_noise_density * noise_.accel_noise_density +
                     increment.extra_accel_noise_density * increment.extra_accel_noise_density;
  const double h = 0.5 * dt;
  Blocks& s = cov_;
  add_noise(h, q_g, q_a);

  // B = [y x] dt/2 C, so that w = -[y x] eps + B bg - D ba. Covariances of the old state with w:
  // x w^T = (x eps^T) [y x] + (x bg^T) B^T - (x ba^T) D^T.
  const Matrix3d B = cross(y, h * C_);
  const Matrix3d Bt = B.transpose();
  const Matrix3d Dt = D.transpose();
  const Matrix3d pw = times_cross(s.pe, y) + s.pg * Bt - s.pa * Dt;
  const Matrix3d vw = times_cross(s.ve, y) + s.vg * Bt - s.va * Dt;
  const Matrix3d ew = times_cross(s.ee, y) + s.eg * Bt;
  const Matrix3d we = ew.transpose();
  const Matrix3d wg = s.gg * B - cross(y, s.eg);
  const Matrix3d wa = -s.aa * D;
  const Matrix3d ww = times_cross(we, y) + wg * Bt - wa * Dt;

  // p' = p + dt u with u = v + w/2, and v' = v + w.
  const Matrix3d wv = vw.transpose();
  const Matrix3d pu = s.pv + 0.5 * pw;
  const Matrix3d uv = s.vv + 0.5 * wv;
  const Matrix3d uw = vw + 0.5 * ww;
  s.pp += dt * (pu + pu.transpose() + dt * (uv + 0.5 * uw));
  s.pv += pw + dt * (uv + uw);
  s.vv += vw + wv + ww;
  // eps' = eps - D bg, and the decay of the biases.
  const Matrix3d pg = s.pg + dt * (s.vg + 0.5 * wg);
  const Matrix3d vg = s.vg + wg;
  const Matrix3d eg = s.eg - s.gg * D;
  s.pe += dt * (s.ve + 0.5 * we) - pg * Dt;
  s.ve += we - vg * Dt;
  s.ee -= D * s.eg.transpose() + eg * Dt;
  s.pg = gyro_bias_decay_ * pg;
  s.vg = gyro_bias_decay_ * vg;
  s.eg = gyro_bias_decay_ * eg;
  s.pa = accel_bias_decay_ * (s.pa + dt * (s.va + 0.5 * wa));
  s.va = accel_bias_decay_ * (s.va + wa);
  s.gg *= gyro_bias_decay_ * gyro_bias_decay_;
  s.aa *= accel_bias_decay_ * accel_bias_decay_;

  add_noise(h, q_g, q_a);
}

Preintegration Preintegrator::result() const {
  Preintegration out{m_};
  put_jacobians(out);
  put_covariance(out.covariance);
  return out;
}

/// eps = C dtheta.
void Preintegrator::put_jacobians(MotionDeltas& out) const {
  const Matrix3d Ct = C_.transpose();
  out.by_gyro_bias.dq = Ct * m_.by_gyro_bias.dq;
  if (!m_.scale) return;
  out.by_gyro_scale.dq = Ct * m_.by_gyro_scale.dq;
  for (std::size_t i = 0; i < out.by_gyro_cross.size(); ++i)
    out.by_gyro_cross[i].dq = Ct * m_.by_gyro_cross[i].dq;
}

void Preintegrator::put_covariance(state::NodeMatrix& S) const {
  using namespace state::block;
  const Matrix3d Ct = C_.transpose();
  const Blocks& s = cov_;
  const auto put = [&S](const state::NodeBlock& row, const state::NodeBlock& column,
                        const Matrix3d& value) {
    state::part(S, row, column) = value;
    state::part(S, column, row) = value.transpose();
  };
  put(position, velocity, s.pv);
  put(position, attitude, s.pe * C_);
  put(position, gyro_bias, s.pg);
  put(position, accel_bias, s.pa);
  put(velocity, attitude, s.ve * C_);
  put(velocity, gyro_bias, s.vg);
  put(velocity, accel_bias, s.va);
  put(attitude, gyro_bias, Ct * s.eg);
  state::part(S, position, position) = s.pp;
  state::part(S, velocity, velocity) = s.vv;
  state::part(S, attitude, attitude) = Ct * s.ee * C_;
  state::part(S, gyro_bias, gyro_bias).diagonal().setConstant(s.gg);
  state::part(S, accel_bias, accel_bias).diagonal().setConstant(s.aa);
}

Preintegration Preintegrator::result_with_bias_decay() const {
  Preintegration out = result();
  out.gyro_bias_decay = std::exp(-out.dt / imu::gyro_markov_bias(noise_).tau);
  out.accel_bias_decay = std::exp(-out.dt / imu::accel_markov_bias(noise_).tau);
  return out;
}

}  // namespace foucault::preintegration
