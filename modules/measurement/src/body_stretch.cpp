#include "foucault/measurement/body_stretch.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

BodyVelocity body_velocity(const BodyStretch& stretch, const state::NavState& x) {
  const geodesy::Place place(x.position);
  const Eigen::Matrix3d C_b_n = x.q_n_b.toRotationMatrix().transpose();
  const Eigen::Vector3d w = C_b_n * x.velocity_n;
  const Eigen::Vector3d g_n =
      Eigen::Vector3d(0, 0, place.gravity) - 2 * place.omega_ie_n.cross(x.velocity_n);
  const Eigen::Vector3d g_b = C_b_n * g_n;
  const Eigen::Vector3d dbg = x.bias.gyro - stretch.bias.gyro;
  const Eigen::Vector3d dba = x.bias.accel - stretch.bias.accel;
  const Eigen::Matrix3d& Q = stretch.turn_by_time;

  BodyVelocity u;
  u.value_b = stretch.turn * w + Q * (dba + w.cross(dbg) - g_b) - stretch.back;
  const Eigen::Matrix3d by_w = stretch.turn - Q * so3::skew(dbg);
  state::columns_of(u.J, state::block::velocity) =
      by_w * C_b_n + 2 * Q * C_b_n * so3::skew(place.omega_ie_n);
  state::columns_of(u.J, state::block::attitude) = by_w * so3::skew(w) - Q * so3::skew(g_b);
  state::columns_of(u.J, state::block::gyro_bias) = Q * so3::skew(w);
  state::columns_of(u.J, state::block::accel_bias) = Q;
  return u;
}

void BodyStretchBuilder::start(int64_t t_ns, const state::ImuBias& bias) {
  *this = BodyStretchBuilder();
  bias_ = bias;
  t_begin_ns_ = t_end_ns_ = t_ns;
}

void BodyStretchBuilder::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  const Eigen::Vector3d half = 0.5 * (increment.dtheta_b - bias_.gyro * dt);
  const Eigen::Quaterniond q_half = so3::exp(half);
  const Eigen::Quaterniond q_begin_mid = q_now_begin_.conjugate() * q_half;
  dvel_begin_ += q_begin_mid * (increment.dvel_b - bias_.accel * dt);
  q_now_begin_ = (q_begin_mid * q_half).normalized().conjugate();
  rate_b_ = increment.dtheta_b / dt;
  t_end_ns_ = increment.t_end_ns;
}

void BodyStretchBuilder::mark() {
  const Eigen::Matrix3d R = q_now_begin_.toRotationMatrix();
  ++instants_;
  turn_ += R;
  turn_by_time_ += 1e-9 * static_cast<double>(t_end_ns_ - t_begin_ns_) * R;
  turned_dvel_ += R * dvel_begin_;
  rates_ += rate_b_;
}

/// R_i is that from the begin to t_i times that from the end to the begin, and R_i dv_i the one
/// from the begin of what the velocity changed by since t_i.
std::optional<BodyStretch> BodyStretchBuilder::stretch() const {
  if (instants_ == 0) return std::nullopt;
  BodyStretch out;
  out.t_begin_ns = t_begin_ns_;
  out.t_end_ns = t_end_ns_;
  out.instants = instants_;
  out.bias = bias_;
  const double share = 1.0 / instants_;
  const Eigen::Matrix3d R_begin_end = q_now_begin_.conjugate().toRotationMatrix();
  out.turn = share * turn_ * R_begin_end;
  out.turn_by_time = share * (out.dt() * turn_ - turn_by_time_) * R_begin_end;
  out.back = share * (turn_ * dvel_begin_ - turned_dvel_);
  out.rate_b = share * rates_;
  return out;
}

}  // namespace foucault::measurement
