#include "foucault/ekf/error_model.h"

#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::ekf {
namespace {

using state::block::accel_bias;
using state::block::attitude;
using state::block::gyro_bias;
using state::block::position;
using state::block::velocity;

/// Change of omega_ie_n by the position error [rad/s/m]: it depends on the latitude alone.
Eigen::Matrix3d earth_rate_by_position(const geodesy::Place& place) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 0) = place.omega_ie_n.z() / place.radius_north;   // -omega sin(latitude)
  m(2, 0) = -place.omega_ie_n.x() / place.radius_north;  // -omega cos(latitude)
  return m;
}

/// Change of omega_en_n by the position error [rad/s/m], without the change of the radii of
/// curvature with latitude (0.7 % of a term of 1e-6 rad/s per 6400 km).
Eigen::Matrix3d transport_rate_by_position(const geodesy::Place& place,
                                           const Eigen::Vector3d& v_n) {
  const Eigen::Vector3d rate = place.omega_en_n(v_n);
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(2, 0) =
      -v_n.y() / (place.radius_east * place.radius_north * place.cos_latitude * place.cos_latitude);
  m(0, 2) = rate.x() / place.radius_east;
  m(1, 2) = rate.y() / place.radius_north;
  m(2, 2) = rate.z() / place.radius_east;
  return m;
}

/// Change of omega_en_n by the velocity error [1/m].
Eigen::Matrix3d transport_rate_by_velocity(const geodesy::Place& place) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 1) = 1 / place.radius_east;
  m(1, 0) = -1 / place.radius_north;
  m(2, 1) = -place.tan_latitude / place.radius_east;
  return m;
}

/// Change of d(dp)/dt by dp [1/s]: the metres of the error are counted at a place that moves.
Eigen::Matrix3d position_by_position(const geodesy::Place& place, const Eigen::Vector3d& v_n) {
  const double rate_north = 1 / place.radius_north;
  const double rate_east = 1 / place.radius_east;
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 0) = -v_n.z() * rate_north;
  m(0, 2) = v_n.x() * rate_north;
  m(1, 0) = v_n.y() * place.tan_latitude * rate_east;
  m(1, 1) = -(v_n.z() + v_n.x() * place.tan_latitude) * rate_east;
  m(1, 2) = v_n.y() * rate_east;
  return m;
}

/// Decay of the slow blocks, and what scale factors do to the motion.
void add_slow_blocks(const MotionIntegrals& integrals, const state::Layout& layout,
                     state::StateMatrix& a) {
  for (const state::SlowBlock& slow : layout.slow()) {
    state::part(a.diagonal(), slow).setConstant(-integrals.dt / slow.tau);
    if (slow.block.name == state::block::gyro_scale.name)
      state::columns_of(state::rows_of(a, attitude), slow) = -integrals.by_gyro_scale;
    if (slow.block.name == state::block::gyro_cross_axis.name)
      state::columns_of(state::rows_of(a, attitude), slow) << -integrals.by_gyro_cross[0],
          -integrals.by_gyro_cross[1];
    if (slow.block.name == state::block::accel_scale.name)
      state::columns_of(state::rows_of(a, velocity), slow) = -integrals.by_accel_scale;
    if (slow.block.name == state::block::accel_cross_axis.name)
      state::columns_of(state::rows_of(a, velocity), slow) = -integrals.by_accel_cross;
  }
}

/// Mean dynamics over the interval times its length, with the attitude error psi = C dtheta in n.
///   psi' = -omega_in x psi - C dbg - C dMg omega - d(omega_in)
///   dv'  = -(C f) x psi - C dba - C dMa f - (2 omega_ie + omega_en) x dv
///          + v x (2 d(omega_ie) + d(omega_en)) + dg
state::StateMatrix mean_dynamics(const MotionIntegrals& integrals, const geodesy::Place& place,
                                 const Eigen::Vector3d& v_n, const ProcessNoise& noise) {
  const double dt = integrals.dt;
  const Eigen::Vector3d omega_ie_n = place.omega_ie_n;
  const Eigen::Vector3d omega_en_n = place.omega_en_n(v_n);
  const Eigen::Matrix3d earth_by_p = earth_rate_by_position(place);
  const Eigen::Matrix3d transport_by_p = transport_rate_by_position(place, v_n);
  const Eigen::Matrix3d transport_by_v = transport_rate_by_velocity(place);

  const int size = noise.layout.size();
  state::StateMatrix a = state::StateMatrix::Zero(size, size);
  state::part(a, position, position) = dt * position_by_position(place, v_n);
  state::part(a, position, velocity) = dt * Eigen::Matrix3d::Identity();

  state::part(a, velocity, position) = dt * (so3::skew(v_n) * (2 * earth_by_p + transport_by_p));
  state::part(a, velocity, position)(2, 2) +=
      dt * 2 * place.gravity / std::sqrt(place.radius_north * place.radius_east);
  state::part(a, velocity, velocity) =
      dt * (so3::skew(v_n) * transport_by_v - so3::skew(2 * omega_ie_n + omega_en_n));
  state::part(a, velocity, attitude) = -so3::skew(integrals.specific_velocity_n);
  state::part(a, velocity, accel_bias) = -integrals.attitude;

  state::part(a, attitude, position) = -dt * (earth_by_p + transport_by_p);
  state::part(a, attitude, velocity) = -dt * transport_by_v;
  state::part(a, attitude, attitude) = -dt * so3::skew(omega_ie_n + omega_en_n);
  state::part(a, attitude, gyro_bias) = -integrals.attitude;

  state::part(a.diagonal(), gyro_bias).setConstant(-dt / imu::gyro_markov_bias(noise.imu).tau);
  state::part(a.diagonal(), accel_bias).setConstant(-dt / imu::accel_markov_bias(noise.imu).tau);
  add_slow_blocks(integrals, noise.layout, a);
  return a;
}

/// Variance that white noise drives into the state during the interval [unit^2].
state::StateVector driving_variance(const MotionIntegrals& integrals, const ProcessNoise& noise) {
  const double dt = integrals.dt;
  state::StateVector variance = state::StateVector::Zero(noise.layout.size());
  state::part(variance, velocity).setConstant(integrals.accel_variance);
  state::part(variance, attitude).setConstant(integrals.gyro_variance);
  state::part(variance, gyro_bias).setConstant(noise.imu.gyro_bias_power() * dt);
  state::part(variance, accel_bias).setConstant(noise.imu.accel_bias_power() * dt);
  for (const state::SlowBlock& slow : noise.layout.slow()) {
    state::part(variance, slow).setConstant(2 * dt / slow.tau * slow.sigma * slow.sigma);
  }
  return variance;
}

/// Puts the closed form of a Gauss-Markov process in the place of its series.
template <class AnyBlock>
void set_markov(const AnyBlock& block, double dt, const imu::MarkovBias& process,
                state::StateVector& decay, state::StateMatrix& q) {
  const double variance = process.sigma * process.sigma;
  state::part(decay, block).setConstant(std::exp(-dt / process.tau));
  state::part(q.diagonal(), block).setConstant(-std::expm1(-2 * dt / process.tau) * variance);
}

void set_markov(const ProcessNoise& noise, double dt, Transition& t) {
  state::StateVector decay(t.q.rows());
  set_markov(gyro_bias, dt, imu::gyro_markov_bias(noise.imu), decay, t.q);
  set_markov(accel_bias, dt, imu::accel_markov_bias(noise.imu), decay, t.q);
  for (const state::SlowBlock& slow : noise.layout.slow())
    set_markov(slow, dt, {slow.sigma, slow.tau}, decay, t.q);
  t.phi.decay = state::sensor_part(decay);
}

state::MotionByState times(const state::MotionByState& X, const Phi& phi) {
  const Eigen::Index rest = phi.decay.size();
  state::MotionByState out(state::kMotionSize, X.cols());
  out.noalias() = X.leftCols<state::kMotionSize>() * phi.motion;
  out.rightCols(rest) += X.rightCols(rest) * phi.decay.asDiagonal();
  return out;
}

/// Powers of the dynamics, from the first to the third.
struct Powers {
  Phi first;
  state::MotionByState second, third;
};

/// Exponential series of the dynamics scaled by `share`, to the third order.
Phi series(const Powers& a, double share) {
  const double s2 = share * share / 2;
  const double s3 = share * share * share / 6;
  Phi out;
  out.motion = share * a.first.motion + s2 * a.second + s3 * a.third;
  out.motion.leftCols<state::kMotionSize>().diagonal().array() += 1;
  const auto d = a.first.decay.array();
  out.decay = 1 + share * d + s2 * d * d + s3 * d * d * d;
  return out;
}

/// Adds weight * S V S^T, V diagonal. The rest's own block is set_markov()'s.
void add_driven(double weight, const Phi& s, const state::StateVector& variance,
                state::StateMatrix& q) {
  const Eigen::Index rest = s.decay.size();
  const state::MotionByState driven = weight * s.motion * variance.asDiagonal();
  q.topLeftCorner<state::kMotionSize, state::kMotionSize>().noalias() +=
      driven * s.motion.transpose();
  q.topRightCorner(state::kMotionSize, rest) += driven.rightCols(rest) * s.decay.asDiagonal();
}

/// Attitude errors in b: at the begin dtheta = C0' psi, at the end dtheta = C1' psi.
void turn_attitude_to_body(const Eigen::Matrix3d& C0, const Eigen::Matrix3d& C1, Transition& t) {
  state::MotionByState& phi = t.phi.motion;
  state::rows_of(phi, attitude) = (C1.transpose() * rows_of(phi, attitude)).eval();
  state::columns_of(phi, attitude) = (state::columns_of(phi, attitude) * C0).eval();
  state::rows_of(t.q, attitude) = (C1.transpose() * rows_of(t.q, attitude)).eval();
  state::columns_of(t.q, attitude) = (state::columns_of(t.q, attitude) * C1).eval();
}

}  // namespace

Phi Phi::identity(Eigen::Index size) {
  Phi phi;
  phi.motion.setIdentity(state::kMotionSize, size);
  phi.decay.setOnes(size - state::kMotionSize);
  return phi;
}

state::StateMatrix Phi::full() const {
  const Eigen::Index size = motion.cols();
  state::StateMatrix phi = state::StateMatrix::Zero(size, size);
  phi.topRows<state::kMotionSize>() = motion;
  phi.diagonal().tail(decay.size()) = decay;
  return phi;
}

Phi operator*(const Phi& later, const Phi& earlier) {
  return {times(later.motion, earlier), later.decay.cwiseProduct(earlier.decay)};
}

void MotionIntegrals::add(const ImuIncrement& increment, const Eigen::Matrix3d& R_n_b_begin,
                          const Eigen::Matrix3d& R_n_b_end, const imu::ImuNoise& noise) {
  const double step = increment.dt();
  const Eigen::Matrix3d R_n_b = 0.5 * (R_n_b_begin + R_n_b_end);
  dt += step;
  specific_velocity_n += R_n_b * increment.dvel_b;
  attitude += step * R_n_b;
  using namespace state::axis_pairs;
  by_gyro_scale += state::by_elements(R_n_b, increment.dtheta_b, scale);
  by_accel_scale += state::by_elements(R_n_b, increment.dvel_b, scale);
  for (std::size_t i = 0; i < gyro_cross.size(); ++i)
    by_gyro_cross[i] += state::by_elements(R_n_b, increment.dtheta_b, gyro_cross[i]);
  by_accel_cross += state::by_elements(R_n_b, increment.dvel_b, accel_cross);
  gyro_variance += step * (std::pow(noise.gyro_noise_density, 2) +
                           std::pow(increment.extra_gyro_noise_density, 2));
  accel_variance += step * (std::pow(noise.accel_noise_density, 2) +
                            std::pow(increment.extra_accel_noise_density, 2));
}

Transition transition(const MotionIntegrals& integrals, const state::NavState& begin,
                      const state::NavState& end, const ProcessNoise& noise) {
  const Eigen::Vector3d v_n = 0.5 * (begin.velocity_n + end.velocity_n);
  const geodesy::Place place(
      geodesy::displaced(begin.position, 0.5 * integrals.dt * v_n, geodesy::Place(begin.position)));
  const state::StateMatrix dynamics = mean_dynamics(integrals, place, v_n, noise);
  const Eigen::Index rest = dynamics.rows() - state::kMotionSize;
  Powers a{{dynamics.topRows<state::kMotionSize>(), dynamics.diagonal().tail(rest)}, {}, {}};
  a.second = times(a.first.motion, a.first);
  a.third = times(a.second, a.first);
  const Phi half = series(a, 0.5);  // from mid-interval to its end

  Transition t;
  t.phi = series(a, 1);
  const state::StateVector variance = driving_variance(integrals, noise);
  t.q = state::StateMatrix::Zero(dynamics.rows(), dynamics.cols());
  add_driven(4.0 / 6, half, variance, t.q);
  add_driven(1.0 / 6, t.phi, variance, t.q);
  t.q.diagonal() += variance / 6;
  t.q.bottomLeftCorner(rest, state::kMotionSize) =
      t.q.topRightCorner(state::kMotionSize, rest).transpose();

  set_markov(noise, integrals.dt, t);
  turn_attitude_to_body(begin.q_n_b.toRotationMatrix(), end.q_n_b.toRotationMatrix(), t);
  return t;
}

state::StateMatrix propagated(const state::StateMatrix& covariance, const Transition& t) {
  const Eigen::Index rest = covariance.rows() - state::kMotionSize;
  const state::MotionByState& rows = t.phi.motion;
  const state::StateVector& decay = t.phi.decay;
  state::MotionByState carried(state::kMotionSize, covariance.cols());
  carried.noalias() = rows * covariance;
  state::StateMatrix next = t.q;
  next.topLeftCorner<state::kMotionSize, state::kMotionSize>().noalias() +=
      carried * rows.transpose();
  const state::MotionByState cross = carried.rightCols(rest) * decay.asDiagonal();
  next.topRightCorner(state::kMotionSize, rest) += cross;
  next.bottomLeftCorner(rest, state::kMotionSize) += cross.transpose();
  next.bottomRightCorner(rest, rest) +=
      decay.asDiagonal() * covariance.bottomRightCorner(rest, rest) * decay.asDiagonal();
  return 0.5 * (next + next.transpose());
}

}  // namespace foucault::ekf
