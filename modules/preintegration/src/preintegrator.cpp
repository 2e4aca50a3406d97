#include "foucault/preintegration/preintegrator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/inertial/increments.h"

namespace foucault {
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
double wandering_power(double power, const MarkovBias& bias) {
  constexpr double kLeastWander = 1e-5;
  constexpr double kHour = 3600;  // [s]
  return std::max(power, kLeastWander * kLeastWander * bias.sigma * bias.sigma / kHour);
}

/// q / |q| for a q that is off by rounding, a Newton step of it.
Eigen::Quaterniond nearly_normalized(const Eigen::Quaterniond& q) {
  return Eigen::Quaterniond(q.coeffs() * (1.5 - 0.5 * q.squaredNorm()));
}

}  // namespace

Preintegrator::Blocks::Blocks() {
  for (Matrix3d* block : {&pp, &pv, &pe, &pg, &pa, &vv, &ve, &vg, &va, &ee, &eg}) block->setZero();
}

Preintegrator::Preintegrator(const ImuNoise& noise, const ImuBias& bias, int64_t t_begin_ns,
                             const std::optional<ImuIncrement>& previous)
    : noise_(noise),
      gyro_bias_power_(wandering_power(noise.gyro_bias_power(), gyro_markov_bias(noise))),
      accel_bias_power_(wandering_power(noise.accel_bias_power(), accel_markov_bias(noise))),
      previous_(previous) {
  m_.t_begin_ns = m_.t_end_ns = t_begin_ns;
  m_.bias = bias;
}

void Preintegrator::add(const ImuIncrement& increment) {
  if (increment.t_begin_ns != m_.t_end_ns || increment.t_end_ns <= increment.t_begin_ns)
    throw std::invalid_argument("preintegration: increments must follow each other");
  const double dt = increment.dt();
  const Vector3d dtheta = increment.dtheta_b - m_.bias.gyro * dt;
  const Vector3d dvel = increment.dvel_b - m_.bias.accel * dt;
  Vector3d previous_dtheta = Vector3d::Zero();
  Vector3d previous_dvel = Vector3d::Zero();
  if (previous_) {
    const double weight = previous_increment_scale(previous_->dt(), dt);
    previous_dtheta = weight * (previous_->dtheta_b - m_.bias.gyro * previous_->dt());
    previous_dvel = weight * (previous_->dvel_b - m_.bias.accel * previous_->dt());
  }
  const Vector3d u = velocity_with_sculling(previous_dtheta, previous_dvel, dtheta, dvel);
  const Vector3d y = C_ * u;
  m_.dq = nearly_normalized(m_.dq * so3::exp(rotation_with_coning(previous_dtheta, dtheta)));
  const Matrix3d C_next = m_.dq.toRotationMatrix();

  propagate_errors(increment, C_, C_next, y);

  m_.iidp += dt * (m_.idp + dt * (m_.dp / 2 + dt * (m_.dv / 6 + y / 24)));
  m_.idp += dt * (m_.dp + dt * (m_.dv / 2 + y / 6));
  m_.dp += dt * (m_.dv + y / 2);
  m_.dv += y;
  m_.t_end_ns = increment.t_end_ns;
  m_.dt = seconds_between(m_.t_begin_ns, m_.t_end_ns);
  C_ = C_next;
  previous_ = increment;
}

void Preintegrator::propagate_errors(const ImuIncrement& increment, const Matrix3d& C,
                                     const Matrix3d& C_next, const Vector3d& y) {
  const double dt = increment.dt();
  const Matrix3d D = (0.5 * dt) * (C + C_next);
  propagate_covariance(increment, C, D, y, dt);
  propagate_jacobians(C, D, y, dt);
}

/// Rows of Phi applied to J, see propagate_covariance.
void Preintegrator::propagate_jacobians(const Matrix3d& C, const Matrix3d& D, const Vector3d& y,
                                        double dt) {
  const Matrix3d v_bg = cross(y, (0.5 * dt) * C - m_.J_dq_bg);
  m_.J_dp_bg += dt * (m_.J_dv_bg + 0.5 * v_bg);
  m_.J_dv_bg += v_bg;
  m_.J_dp_ba += dt * (m_.J_dv_ba - 0.5 * D);
  m_.J_dv_ba -= D;
  m_.J_dq_bg -= D;
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
  gyro_bias_decay_ = std::exp(-dt / gyro_markov_bias(noise_).tau);
  accel_bias_decay_ = std::exp(-dt / accel_markov_bias(noise_).tau);
}

/// Phi of one sample, the exact derivative of add():
///   eps' = eps - D bg
///   v'   = v + w,           w = -[y x] (eps - dt/2 C bg) - D ba
///   p'   = p + dt (v + w/2)
///   bg'  = decay bg,  ba' = decay ba
/// and S' = Phi (S + dt/2 W) Phi^T + dt/2 W, W = diag(0, q_a, q_g, q_bg, q_ba): the trapezoid of
/// (42) with its term of second order, (Phi - I) W (Phi - I)^T dt/2, kept. Without that term a
/// single sample would have a covariance that is not positive. (40), (42), (43)
void Preintegrator::propagate_covariance(const ImuIncrement& increment, const Matrix3d& C,
                                         const Matrix3d& D, const Vector3d& y, double dt) {
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
  const Matrix3d B = cross(y, h * C);
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
  Preintegration out = m_;
  const Matrix3d Ct = C_.transpose();
  out.J_dq_bg = Ct * m_.J_dq_bg;
  const Blocks& s = cov_;
  Matrix15d& S = out.covariance;
  using namespace error_state;
  const auto put = [&S](int row, int column, const Matrix3d& block) {
    S.block<3, 3>(row, column) = block;
    S.block<3, 3>(column, row) = block.transpose();
  };
  put(kPosition, kVelocity, s.pv);
  put(kPosition, kAttitude, s.pe * C_);
  put(kPosition, kGyroBias, s.pg);
  put(kPosition, kAccelBias, s.pa);
  put(kVelocity, kAttitude, s.ve * C_);
  put(kVelocity, kGyroBias, s.vg);
  put(kVelocity, kAccelBias, s.va);
  put(kAttitude, kGyroBias, Ct * s.eg);
  S.block<3, 3>(kPosition, kPosition) = s.pp;
  S.block<3, 3>(kVelocity, kVelocity) = s.vv;
  S.block<3, 3>(kAttitude, kAttitude) = Ct * s.ee * C_;
  S.block<3, 3>(kGyroBias, kGyroBias).diagonal().setConstant(s.gg);
  S.block<3, 3>(kAccelBias, kAccelBias).diagonal().setConstant(s.aa);
  return out;
}

Preintegration Preintegrator::result_with_bias_decay() const {
  Preintegration out = result();
  out.gyro_bias_decay = std::exp(-out.dt / gyro_markov_bias(noise_).tau);
  out.accel_bias_decay = std::exp(-out.dt / accel_markov_bias(noise_).tau);
  return out;
}

}  // namespace foucault
