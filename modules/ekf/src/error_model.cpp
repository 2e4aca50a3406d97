#include "foucault/ekf/error_model.h"

#include <cmath>

#include "foucault/core/so3.h"

namespace foucault::ekf {
namespace {

using error_state::kAccelBias;
using error_state::kAttitude;
using error_state::kGyroBias;
using error_state::kPosition;
using error_state::kVelocity;

/// Change of omega_ie_n by the position error [rad/s/m]: it depends on the latitude alone.
Eigen::Matrix3d earth_rate_by_position(const Place& place) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 0) = place.omega_ie_n.z() / place.radius_north;   // -omega sin(latitude)
  m(2, 0) = -place.omega_ie_n.x() / place.radius_north;  // -omega cos(latitude)
  return m;
}

/// Change of omega_en_n by the position error [rad/s/m], without the change of the radii of
/// curvature with latitude (0.7 % of a term of 1e-6 rad/s per 6400 km).
Eigen::Matrix3d transport_rate_by_position(const Place& place, const Eigen::Vector3d& v_n) {
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
Eigen::Matrix3d transport_rate_by_velocity(const Place& place) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 1) = 1 / place.radius_east;
  m(1, 0) = -1 / place.radius_north;
  m(2, 1) = -place.tan_latitude / place.radius_east;
  return m;
}

/// Change of d(dp)/dt by dp [1/s]: the metres of the error are counted at a place that moves.
Eigen::Matrix3d position_by_position(const Place& place, const Eigen::Vector3d& v_n) {
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

/// Mean dynamics over the interval times its length, with the attitude error psi = C dtheta in n.
///   psi' = -omega_in x psi - C dbg - C diag(omega) dsg - d(omega_in)
///   dv'  = -(C f) x psi - C dba - C diag(f) dsa - (2 omega_ie + omega_en) x dv
///          + v x (2 d(omega_ie) + d(omega_en)) + dg
Matrix mean_dynamics(const MotionIntegrals& integrals, const Place& place,
                     const Eigen::Vector3d& v_n, const ProcessNoise& noise) {
  const double dt = integrals.dt;
  const Eigen::Vector3d omega_ie_n = place.omega_ie_n;
  const Eigen::Vector3d omega_en_n = place.omega_en_n(v_n);
  const Eigen::Matrix3d earth_by_p = earth_rate_by_position(place);
  const Eigen::Matrix3d transport_by_p = transport_rate_by_position(place, v_n);
  const Eigen::Matrix3d transport_by_v = transport_rate_by_velocity(place);

  Matrix a = Matrix::Zero(noise.size(), noise.size());
  a.block<3, 3>(kPosition, kPosition) = dt * position_by_position(place, v_n);
  a.block<3, 3>(kPosition, kVelocity) = dt * Eigen::Matrix3d::Identity();

  a.block<3, 3>(kVelocity, kPosition) = dt * (so3::skew(v_n) * (2 * earth_by_p + transport_by_p));
  a(kVelocity + 2, kPosition + 2) +=
      dt * 2 * place.gravity / std::sqrt(place.radius_north * place.radius_east);
  a.block<3, 3>(kVelocity, kVelocity) =
      dt * (so3::skew(v_n) * transport_by_v - so3::skew(2 * omega_ie_n + omega_en_n));
  a.block<3, 3>(kVelocity, kAttitude) = -so3::skew(integrals.specific_velocity_n);
  a.block<3, 3>(kVelocity, kAccelBias) = -integrals.attitude;

  a.block<3, 3>(kAttitude, kPosition) = -dt * (earth_by_p + transport_by_p);
  a.block<3, 3>(kAttitude, kVelocity) = -dt * transport_by_v;
  a.block<3, 3>(kAttitude, kAttitude) = -dt * so3::skew(omega_ie_n + omega_en_n);
  a.block<3, 3>(kAttitude, kGyroBias) = -integrals.attitude;

  a.diagonal().segment<3>(kGyroBias).setConstant(-dt / gyro_markov_bias(noise.imu).tau);
  a.diagonal().segment<3>(kAccelBias).setConstant(-dt / accel_markov_bias(noise.imu).tau);
  if (noise.with_scale) {
    a.block<3, 3>(kAttitude, kGyroScale) = -integrals.attitude_rate;
    a.block<3, 3>(kVelocity, kAccelScale) = -integrals.attitude_force;
    a.diagonal().segment<6>(kGyroScale).setConstant(-dt / noise.scale_tau);
  }
  return a;
}

/// Variance that white noise drives into the state during the interval [unit^2].
Vector driving_variance(const MotionIntegrals& integrals, const ProcessNoise& noise) {
  const double dt = integrals.dt;
  Vector variance = Vector::Zero(noise.size());
  variance.segment<3>(kVelocity).setConstant(integrals.accel_variance);
  variance.segment<3>(kAttitude).setConstant(integrals.gyro_variance);
  variance.segment<3>(kGyroBias).setConstant(noise.imu.gyro_bias_power() * dt);
  variance.segment<3>(kAccelBias).setConstant(noise.imu.accel_bias_power() * dt);
  if (noise.with_scale) {
    const double rate = 2 * dt / noise.scale_tau;
    variance.segment<3>(kGyroScale).setConstant(rate * std::pow(noise.gyro_scale_sigma, 2));
    variance.segment<3>(kAccelScale).setConstant(rate * std::pow(noise.accel_scale_sigma, 2));
  }
  return variance;
}

/// Puts the closed form of Gauss-Markov processes in the place of its series.
void set_markov(int row, double dt, const MarkovBias& process, Transition& t) {
  const double variance = process.sigma * process.sigma;
  t.phi.block<3, 3>(row, row) = std::exp(-dt / process.tau) * Eigen::Matrix3d::Identity();
  t.q.block<3, 3>(row, row) =
      -std::expm1(-2 * dt / process.tau) * variance * Eigen::Matrix3d::Identity();
}

/// The rows of position, velocity and attitude. Those of the sensors' errors below hold nothing but
/// their decay on the diagonal, so that products come down to these rows.
constexpr int kMotion = 9;
using MotionRows =
    Eigen::Matrix<double, kMotion, Eigen::Dynamic, Eigen::ColMajor, kMotion, kSizeWithScale>;

/// X times a matrix of `rows` above the diagonal `decay`.
MotionRows times(const MotionRows& X, const MotionRows& rows, const Vector& decay) {
  MotionRows out(kMotion, X.cols());
  out.noalias() = X.leftCols<kMotion>() * rows;
  out.rightCols(decay.size()) += X.rightCols(decay.size()) * decay.asDiagonal();
  return out;
}

/// Exponential series of the dynamics scaled by `share`, to the third order: rows, and diagonal of
/// the rest.
struct Series {
  MotionRows rows;
  Vector diagonal;
};
struct Powers {
  MotionRows first, second, third;
  Vector decay;
};
Series series(const Powers& a, double share) {
  const double s2 = share * share / 2;
  const double s3 = share * share * share / 6;
  Series out;
  out.rows = share * a.first + s2 * a.second + s3 * a.third;
  out.rows.leftCols<kMotion>().diagonal().array() += 1;
  const auto d = a.decay.array();
  out.diagonal = 1 + share * d + s2 * d * d + s3 * d * d * d;
  return out;
}

/// Adds weight * S V S^T, V diagonal. The rest's own block is set_markov()'s.
void add_driven(double weight, const Series& s, const Vector& variance, Matrix& q) {
  const Eigen::Index rest = s.diagonal.size();
  const MotionRows driven = weight * s.rows * variance.asDiagonal();
  q.topLeftCorner<kMotion, kMotion>().noalias() += driven * s.rows.transpose();
  q.topRightCorner(kMotion, rest) += driven.rightCols(rest) * s.diagonal.asDiagonal();
}

/// Attitude errors in b: at the begin dtheta = C0' psi, at the end dtheta = C1' psi.
void turn_attitude_to_body(const Eigen::Matrix3d& C0, const Eigen::Matrix3d& C1, Transition& t) {
  t.phi.middleRows<3>(kAttitude) = (C1.transpose() * t.phi.middleRows<3>(kAttitude)).eval();
  t.phi.middleCols<3>(kAttitude) = (t.phi.middleCols<3>(kAttitude) * C0).eval();
  t.q.middleRows<3>(kAttitude) = (C1.transpose() * t.q.middleRows<3>(kAttitude)).eval();
  t.q.middleCols<3>(kAttitude) = (t.q.middleCols<3>(kAttitude) * C1).eval();
}

}  // namespace

FullState corrected(const FullState& state, const Vector& error) {
  FullState next = state;
  next.motion = corrected(state.motion, error.head<9>());
  next.bias.gyro += error.segment<3>(kGyroBias);
  next.bias.accel += error.segment<3>(kAccelBias);
  if (error.size() == kSizeWithScale) {
    next.gyro_scale += error.segment<3>(kGyroScale);
    next.accel_scale += error.segment<3>(kAccelScale);
  }
  return next;
}

Vector difference(const FullState& from, const FullState& to, int size) {
  Vector error(size);
  error.head<9>() = difference(from.motion, to.motion);
  error.segment<3>(kGyroBias) = to.bias.gyro - from.bias.gyro;
  error.segment<3>(kAccelBias) = to.bias.accel - from.bias.accel;
  if (size == kSizeWithScale) {
    error.segment<3>(kGyroScale) = to.gyro_scale - from.gyro_scale;
    error.segment<3>(kAccelScale) = to.accel_scale - from.accel_scale;
  }
  return error;
}

ImuIncrement compensated(const ImuIncrement& increment, const FullState& state) {
  ImuIncrement clean = without_bias(increment, state.bias);
  clean.dtheta_b.array() /= 1 + state.gyro_scale.array();
  clean.dvel_b.array() /= 1 + state.accel_scale.array();
  return clean;
}

void MotionIntegrals::add(const ImuIncrement& increment, const Eigen::Matrix3d& R_n_b_begin,
                          const Eigen::Matrix3d& R_n_b_end, const ImuNoise& noise) {
  const double step = increment.dt();
  const Eigen::Matrix3d R_n_b = 0.5 * (R_n_b_begin + R_n_b_end);
  dt += step;
  specific_velocity_n += R_n_b * increment.dvel_b;
  attitude += step * R_n_b;
  attitude_rate += R_n_b * increment.dtheta_b.asDiagonal();
  attitude_force += R_n_b * increment.dvel_b.asDiagonal();
  gyro_variance += step * (std::pow(noise.gyro_noise_density, 2) +
                           std::pow(increment.extra_gyro_noise_density, 2));
  accel_variance += step * (std::pow(noise.accel_noise_density, 2) +
                            std::pow(increment.extra_accel_noise_density, 2));
}

Transition transition(const MotionIntegrals& integrals, const StrapdownState& begin,
                      const StrapdownState& end, const ProcessNoise& noise) {
  const Eigen::Vector3d v_n = 0.5 * (begin.v_n + end.v_n);
  const Place place(displaced(begin.position, 0.5 * integrals.dt * v_n, Place(begin.position)));
  const Matrix dynamics = mean_dynamics(integrals, place, v_n, noise);
  const Eigen::Index rest = dynamics.rows() - kMotion;
  Powers a{dynamics.topRows<kMotion>(), {}, {}, dynamics.diagonal().tail(rest)};
  a.second = times(a.first, a.first, a.decay);
  a.third = times(a.second, a.first, a.decay);
  const Series whole = series(a, 1);
  const Series half = series(a, 0.5);  // from mid-interval to its end

  Transition t;
  t.phi = Matrix::Zero(dynamics.rows(), dynamics.cols());
  t.phi.topRows<kMotion>() = whole.rows;
  const Vector variance = driving_variance(integrals, noise);
  t.q = Matrix::Zero(dynamics.rows(), dynamics.cols());
  add_driven(4.0 / 6, half, variance, t.q);
  add_driven(1.0 / 6, whole, variance, t.q);
  t.q.diagonal() += variance / 6;
  t.q.bottomLeftCorner(rest, kMotion) = t.q.topRightCorner(kMotion, rest).transpose();

  set_markov(kGyroBias, integrals.dt, gyro_markov_bias(noise.imu), t);
  set_markov(kAccelBias, integrals.dt, accel_markov_bias(noise.imu), t);
  if (noise.with_scale) {
    set_markov(kGyroScale, integrals.dt, {noise.gyro_scale_sigma, noise.scale_tau}, t);
    set_markov(kAccelScale, integrals.dt, {noise.accel_scale_sigma, noise.scale_tau}, t);
  }
  turn_attitude_to_body(begin.q_n_b.toRotationMatrix(), end.q_n_b.toRotationMatrix(), t);
  return t;
}

Matrix propagated(const Matrix& covariance, const Transition& t) {
  const Eigen::Index rest = covariance.rows() - kMotion;
  const MotionRows rows = t.phi.topRows<kMotion>();
  const Vector decay = t.phi.diagonal().tail(rest);
  MotionRows carried(kMotion, covariance.cols());
  carried.noalias() = rows * covariance;
  Matrix next = t.q;
  next.topLeftCorner<kMotion, kMotion>().noalias() += carried * rows.transpose();
  const MotionRows cross = carried.rightCols(rest) * decay.asDiagonal();
  next.topRightCorner(kMotion, rest) += cross;
  next.bottomLeftCorner(rest, kMotion) += cross.transpose();
  next.bottomRightCorner(rest, rest) +=
      decay.asDiagonal() * covariance.bottomRightCorner(rest, rest) * decay.asDiagonal();
  return 0.5 * (next + next.transpose());
}

}  // namespace foucault::ekf
