#include "foucault/preintegration/preintegrator.h"

#include <cmath>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/inertial/increments.h"

namespace foucault {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// v x M, column by column.
Matrix3d cross(const Vector3d& v, const Matrix3d& M) {
  Matrix3d out;
  for (int j = 0; j < 3; ++j) out.col(j) = v.cross(M.col(j));
  return out;
}

}  // namespace

Preintegrator::Blocks::Blocks() {
  for (Matrix3d* block : {&pp, &pv, &pe, &pg, &pa, &vv, &ve, &vg, &va, &ee, &eg}) block->setZero();
}

Preintegrator::Preintegrator(const ImuNoise& noise, const ImuBias& bias, int64_t t_begin_ns,
                             const std::optional<ImuIncrement>& previous)
    : noise_(noise), previous_(previous) {
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
  m_.dq = (m_.dq * so3::exp(rotation_with_coning(previous_dtheta, dtheta))).normalized();
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
  cov_.gg += h * noise_.gyro_bias_power();
  cov_.aa += h * noise_.accel_bias_power();
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
  if (dt != bias_decay_dt_) {
    bias_decay_dt_ = dt;
    bias_decay_ = std::exp(-dt / noise_.bias_tau);
  }
  const double e = bias_decay_;
  const double q_g =
      std::pow(noise_.gyro_noise_density, 2) + std::pow(increment.extra_gyro_noise_density, 2);
  const double q_a =
      std::pow(noise_.accel_noise_density, 2) + std::pow(increment.extra_accel_noise_density, 2);
  const double h = 0.5 * dt;
  Blocks& s = cov_;
  add_noise(h, q_g, q_a);

  const Matrix3d B = cross(y, h * C);  // d w / d bg

  // Left product, row by row: (Phi S) for rows v and eps against the columns that are needed.
  // Columns: p, v, e, g, a; transposes of the stored upper blocks stand for the lower ones.
  const Matrix3d wp = -cross(y, s.pe.transpose()) + B * s.pg.transpose() - D * s.pa.transpose();
  const Matrix3d wv = -cross(y, s.ve.transpose()) + B * s.vg.transpose() - D * s.va.transpose();
  const Matrix3d we = -cross(y, s.ee) + B * s.eg.transpose();
  const Matrix3d wg = -cross(y, s.eg) + B * s.gg;
  const Matrix3d wa = -D * s.aa;
  const Matrix3d ww = -cross(y, we.transpose()).transpose() + wg * B.transpose() -
                      wa * D.transpose();  // w w^T; it is symmetric

  const Matrix3d pp = s.pp, pv = s.pv, vv = s.vv;
  const Matrix3d pw = wp.transpose();  // p w^T
  const Matrix3d vw = wv.transpose();  // v w^T

  // p' = p + dt v + h w
  s.pp = pp + dt * (pv + pv.transpose()) + h * (pw + pw.transpose()) + dt * dt * vv +
         h * dt * (vw + vw.transpose()) + h * h * ww;
  // v' = v + w
  s.pv = pv + pw + dt * (vv + vw) + h * (wv + ww);
  s.vv = vv + vw + vw.transpose() + ww;
  // eps' = eps - D bg
  const Matrix3d p_e = s.pe + dt * s.ve + h * we;
  const Matrix3d p_g = s.pg + dt * s.vg + h * wg;
  const Matrix3d p_a = s.pa + dt * s.va + h * wa;
  const Matrix3d v_e = s.ve + we;
  const Matrix3d v_g = s.vg + wg;
  s.pe = p_e - p_g * D.transpose();
  s.ve = v_e - v_g * D.transpose();
  const Matrix3d eg_D = s.eg * D.transpose();
  s.ee += s.gg * D * D.transpose() - eg_D - eg_D.transpose();
  s.pg = e * p_g;
  s.vg = e * v_g;
  s.pa = e * p_a;
  s.va = e * (s.va + wa);
  s.eg = e * (s.eg - s.gg * D);
  s.gg *= e * e;
  s.aa *= e * e;

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
  out.bias_decay = std::exp(-out.dt / noise_.bias_tau);
  return out;
}

}  // namespace foucault
