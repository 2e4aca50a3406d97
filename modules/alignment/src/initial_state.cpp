#include "initial_state.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/state/kalman.h"

namespace foucault::alignment {

namespace {

using namespace state::block;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Normal gravity differs from true gravity, by 50 mGal in usual terrain [m/s^2].
constexpr double kGravitySigma = 5e-4;
constexpr double kContradiction = 25;  // chi-square, 3 degrees of freedom: 2e-5 by chance

Vector3d gravity_n(const Geodetic& position) {
  return {0, 0, geodesy::wgs84::normal_gravity(position.latitude, position.height)};
}

double prior_sigma(double turn_on_sigma, double bias_sigma) {
  return std::hypot(turn_on_sigma, bias_sigma);
}

/// Of b, without its bias.
Vector3d rate_n(const AlignmentFindings& findings) {
  return geodesy::wgs84::earth_rate_n(findings.fix.antenna.latitude) + findings.turn_n;
}

/// A scalar that is to be given columns.
state::Linearized scalar(const state::Epoch& epoch, double innovation, double variance) {
  state::Linearized z(1, static_cast<int>(epoch.covariance.cols()));
  z.r[0] = innovation;
  z.R(0, 0) = variance;
  return z;
}

/// A measured gyroscope bias together with what was known before; unless the two contradict each
/// other, when the measurement is believed.
void fuse_gyro_prior(state::Epoch& epoch, double sigma) {
  const Matrix3d prior = sigma * sigma * Matrix3d::Identity();
  const Matrix3d sum = epoch.covariance_of(gyro_bias) + prior;
  if (epoch.bias.gyro.dot(sum.ldlt().solve(epoch.bias.gyro)) > kContradiction) return;
  for (int axis = 0; axis < 3; ++axis) {
    state::Linearized z = scalar(epoch, -epoch.bias.gyro[axis], sigma * sigma);
    state::columns_of(z.H, gyro_bias)(0, axis) = 1;
    state::kalman_update(z, epoch, epoch.covariance);
  }
}

/// The length of the specific force against the one expected: bias and scale along it.
void fuse_force_length(state::Epoch& epoch, const AlignmentFindings& findings,
                       const state::Layout& layout) {
  const Vector3d& f_b = findings.specific_force_b;
  const Vector3d along_b = f_b.normalized();
  const Vector3d expected_n = specific_force_n(findings);
  const Vector3d along_n = expected_n.normalized();
  const double variance = along_b.dot(findings.specific_force_covariance * along_b) +
                          along_n.dot(findings.motion_covariance.block<3, 3>(3, 3) * along_n) +
                          kGravitySigma * kGravitySigma;
  state::Linearized z = scalar(epoch, f_b.norm() - expected_n.norm(), variance);
  state::columns_of(z.H, accel_bias) = along_b.transpose();
  if (const state::SlowBlock* scale = layout.find(accel_scale))
    state::columns_of(z.H, *scale) = expected_n.norm() * along_b.cwiseAbs2().transpose();
  state::kalman_update(z, epoch, epoch.covariance);
}

/// 0 if they are taken as right.
double accel_scale_sigma(const state::Layout& layout) {
  const state::SlowBlock* scale = layout.find(accel_scale);
  return scale ? scale->sigma : 0;
}

/// The prior of the accelerometer bias; wider if one axis shows it to be too narrow.
double accel_prior_sigma(const AlignmentFindings& findings, const imu::ImuNoise& noise,
                         const state::Layout& layout) {
  const double expected = specific_force_n(findings).norm();
  const double excess = findings.specific_force_b.norm() - expected;
  const double uncertain = std::sqrt(findings.motion_covariance.block<3, 3>(3, 3).trace() +
                                     findings.specific_force_covariance.trace() +
                                     std::pow(accel_scale_sigma(layout) * expected, 2));
  const double sigma = prior_sigma(noise.accel_turn_on_sigma, noise.accel_bias_sigma);
  return std::max(sigma, (std::abs(excess) - 3 * uncertain) / 3);
}

/// Independent errors in, state errors out: P = J S J^T, block by block.
state::StateMatrix covariance_of(const AlignmentFindings& findings, const Quaterniond& q_n_b,
                                 double accel_bias_sigma, const state::Layout& layout) {
  constexpr int kFix = 0, kMotion = 3, kForce = 9, kBias = 12, kHeading = 15, kGyro = 16;
  constexpr int kScale = 19, kSources = 22;
  using Jacobian = Eigen::Matrix<double, 3, kSources>;
  Eigen::Matrix<double, kSources, kSources> S = Eigen::Matrix<double, kSources, kSources>::Zero();
  S.block<3, 3>(kFix, kFix) = findings.fix.position_covariance;
  S.block<6, 6>(kMotion, kMotion) = findings.motion_covariance;
  S.block<3, 3>(kForce, kForce) = findings.specific_force_covariance;
  S.block<3, 3>(kBias, kBias) = accel_bias_sigma * accel_bias_sigma * Matrix3d::Identity();
  S(kHeading, kHeading) = findings.heading_variance;
  S.block<3, 3>(kGyro, kGyro) = findings.gyro_covariance;
  S.diagonal().segment<3>(kScale).setConstant(std::pow(accel_scale_sigma(layout), 2));

  const Matrix3d R = q_n_b.toRotationMatrix();
  const Vector3d f = R.transpose() * specific_force_n(findings);
  const Vector3d along = f.normalized();
  const Vector3d down = R.transpose() * Vector3d::UnitZ();
  const Vector3d about = along / along.dot(down);  // turns the heading, keeps the level
  const Matrix3d level = so3::skew(f) / f.squaredNorm();
  const Matrix3d keep_heading = Matrix3d::Identity() - about * down.transpose();

  Jacobian by_attitude = Jacobian::Zero();
  by_attitude.block<3, 3>(0, kBias) = keep_heading * level;
  by_attitude.block<3, 3>(0, kForce) = keep_heading * level;
  by_attitude.block<3, 3>(0, kScale) = keep_heading * level * f.asDiagonal();
  by_attitude.block<3, 3>(0, kMotion + 3) = keep_heading * level * R.transpose();
  by_attitude.col(kHeading) = about;

  const Vector3d rate_b = R.transpose() * rate_n(findings);
  Jacobian by_gyro_bias = -so3::skew(rate_b) * by_attitude;
  by_gyro_bias.block<3, 3>(0, kGyro).setIdentity();

  const Vector3d& lever = findings.fix.p_b_a;
  Jacobian by_position = R * so3::skew(lever) * by_attitude;
  by_position.block<3, 3>(0, kFix) += Matrix3d::Identity();
  Jacobian by_velocity = R * so3::skew(findings.omega_b.cross(lever)) * by_attitude;
  by_velocity.block<3, 3>(0, kMotion) += Matrix3d::Identity();

  state::StateByColumns<kSources> J =
      state::StateByColumns<kSources>::Zero(layout.size(), kSources);
  state::rows_of(J, position) = by_position;
  state::rows_of(J, velocity) = by_velocity;
  state::rows_of(J, attitude) = by_attitude;
  state::rows_of(J, gyro_bias) = by_gyro_bias;
  state::rows_of(J, accel_bias).middleCols<3>(kBias).setIdentity();
  if (const state::SlowBlock* scale = layout.find(accel_scale))
    state::columns_of(J.transpose(), *scale).middleRows<3>(kScale).setIdentity();
  state::StateMatrix P = J * S * J.transpose();
  for (const state::SlowBlock& slow : layout.slow())
    state::part(P.diagonal(), slow).setConstant(slow.sigma * slow.sigma);
  return P;
}

}  // namespace

/// From v_dot = f + g - 2 omega_ie x v.
Vector3d specific_force_n(const AlignmentFindings& findings) {
  const Vector3d earth_rate = geodesy::wgs84::earth_rate_n(findings.fix.antenna.latitude);
  return findings.acceleration_n + 2 * earth_rate.cross(findings.antenna_velocity_n) -
         gravity_n(findings.fix.antenna);
}

Quaterniond attitude_of(const AlignmentFindings& findings) {
  const Vector3d force_n = specific_force_n(findings);
  const Vector3d forward_b = findings.q_v_b.conjugate() * Vector3d::UnitX();
  Quaterniond q = Quaterniond::FromTwoVectors(findings.specific_force_b, force_n);
  // Turning about the force changes the heading by almost the angle: a few rounds are exact.
  const Vector3d axis = force_n.normalized();
  for (int round = 0; round < 20; ++round) {
    const double missing = so3::wrap(findings.heading - geodesy::azimuth(q * forward_b));
    if (std::abs(missing) < 1e-12) break;
    q = Quaterniond(Eigen::AngleAxisd(axis.z() < 0 ? -missing : missing, axis)) * q;
  }
  return q.normalized();
}

void place_at_imu(state::Epoch& epoch, const GnssFix& fix, const Vector3d& antenna_velocity_n,
                  const Vector3d& omega_b) {
  epoch.t_ns = fix.t_ns;
  epoch.position = geodesy::LocalFrame(fix.antenna).to_geodetic(-(epoch.q_n_b * fix.p_b_a));
  epoch.velocity_n = antenna_velocity_n - epoch.q_n_b * omega_b.cross(fix.p_b_a);
}

state::Epoch initial_state(const AlignmentFindings& findings, const imu::ImuNoise& noise,
                           const state::Layout& layout) {
  state::Epoch epoch;
  epoch.slow = state::SlowVector::Zero(layout.slow_size());
  epoch.q_n_b = attitude_of(findings);
  place_at_imu(epoch, findings.fix, findings.antenna_velocity_n, findings.omega_b);
  epoch.bias.gyro = findings.gyro_b - epoch.q_n_b.conjugate() * rate_n(findings);
  epoch.covariance =
      covariance_of(findings, epoch.q_n_b, accel_prior_sigma(findings, noise, layout), layout);
  fuse_gyro_prior(epoch, prior_sigma(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma));
  fuse_force_length(epoch, findings, layout);
  return epoch;
}

state::Epoch with_given_angles(const state::Epoch& epoch, const Quaterniond& q_v_b,
                               const GivenAngles& given) {
  so3::Euler euler = so3::to_euler(epoch.q_n_b * q_v_b.conjugate());
  const Matrix3d euler_by_b = so3::euler_jacobian(euler) * q_v_b.toRotationMatrix();
  const Matrix3d b_by_euler = euler_by_b.inverse();
  Vector3d keep = Vector3d::Ones(), variance = Vector3d::Zero();
  const auto replace = [&](const std::optional<GivenAngle>& angle, double& value, int row) {
    if (!angle) return;
    value = angle->value;
    keep[row] = 0;
    variance[row] = angle->sigma * angle->sigma;
  };
  replace(given.roll, euler.roll, 0);
  replace(given.pitch, euler.pitch, 1);
  replace(given.heading, euler.heading, 2);
  if (keep == Vector3d::Ones()) return epoch;

  state::Epoch result = epoch;
  result.q_n_b = so3::from_euler(euler) * q_v_b;
  state::NodeMatrix T = state::NodeMatrix::Identity();
  state::part(T, attitude, attitude) = b_by_euler * keep.asDiagonal() * euler_by_b;
  state::node_part(result.covariance) = T * state::node_part(epoch.covariance) * T.transpose();
  state::node_by_slow(result.covariance) = T * state::node_by_slow(epoch.covariance);
  state::slow_by_node(result.covariance) = state::node_by_slow(result.covariance).transpose();
  state::part(result.covariance, attitude, attitude) +=
      b_by_euler * variance.asDiagonal() * b_by_euler.transpose();
  return result;
}

state::Epoch with_antenna_blocks(const state::Epoch& epoch, const state::Layout& layout) {
  const state::SlowBlock* arm = layout.find(state::block::lever_arm);
  const state::SlowBlock* offset = layout.find(state::block::time_offset);
  if (!arm && !offset) return epoch;
  state::Epoch out = state::with_slow_blocks(epoch, layout);
  state::StateMatrix J = state::StateMatrix::Identity(layout.size(), layout.size());
  if (arm) {
    state::columns_of(state::rows_of(J, position), *arm) = -epoch.q_n_b.toRotationMatrix();
  }
  if (offset) state::columns_of(state::rows_of(J, position), *offset) = epoch.velocity_n;
  out.covariance = J * out.covariance * J.transpose();
  return out;
}

AlignmentFindings with_antenna_heading(const AlignmentFindings& findings) {
  constexpr double kUsedAgain = 2;  // in the run: with twice the variance
  const GnssHeading& measured = *findings.fix.heading;
  const Vector3d along_v(std::cos(measured.baseline), std::sin(measured.baseline), 0);
  AlignmentFindings out = findings;
  out.heading = so3::wrap(measured.azimuth - measured.baseline);
  const Quaterniond q_n_v = attitude_of(out) * findings.q_v_b.conjugate();
  out.heading = so3::wrap(out.heading + measured.azimuth - geodesy::azimuth(q_n_v * along_v));
  out.heading_variance = kUsedAgain * measured.sigma * measured.sigma;
  return out;
}

/// As covariance_of() has the error of the heading.
state::Epoch with_baseline_block(const state::Epoch& epoch, const AlignmentFindings& findings,
                                 const state::Layout& layout) {
  const state::SlowBlock* baseline = layout.find(baseline_heading);
  if (!baseline) return epoch;
  state::Epoch out = state::with_slow_blocks(epoch, layout);
  const Matrix3d R = epoch.q_n_b.toRotationMatrix();
  const Vector3d along_n = specific_force_n(findings).normalized();
  const Vector3d by_heading = R.transpose() * along_n / along_n.z();
  const Vector3d rate_b = R.transpose() * rate_n(findings);
  const Vector3d& lever = findings.fix.p_b_a;
  state::StateMatrix J = state::StateMatrix::Identity(layout.size(), layout.size());
  const auto by_baseline = [&](const state::NodeBlock& block) {
    return state::columns_of(state::rows_of(J, block), *baseline);
  };
  by_baseline(position) = -R * lever.cross(by_heading);
  by_baseline(velocity) = -R * findings.omega_b.cross(lever).cross(by_heading);
  by_baseline(attitude) = -by_heading;
  by_baseline(gyro_bias) = rate_b.cross(by_heading);
  out.covariance = J * out.covariance * J.transpose();
  return out;
}

state::Epoch given_state(const GnssFix& fix, const Vector3d& antenna_velocity_n,
                         const Matrix3d& velocity_covariance, const Vector3d& omega_b,
                         const Quaterniond& q_v_b, const GivenAngles& given,
                         const imu::ImuNoise& noise) {
  const so3::Euler euler{given.roll->value, given.pitch->value, given.heading->value};
  const Vector3d variance(given.roll->sigma * given.roll->sigma,
                          given.pitch->sigma * given.pitch->sigma,
                          given.heading->sigma * given.heading->sigma);
  state::Epoch epoch;
  epoch.q_n_b = so3::from_euler(euler) * q_v_b;
  place_at_imu(epoch, fix, antenna_velocity_n, omega_b);
  const Matrix3d b_by_euler = (so3::euler_jacobian(euler) * q_v_b.toRotationMatrix()).inverse();
  const double gyro_sigma = prior_sigma(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma);
  const double accel_sigma = prior_sigma(noise.accel_turn_on_sigma, noise.accel_bias_sigma);
  state::NodeMatrix J = state::NodeMatrix::Identity();
  const Matrix3d R = epoch.q_n_b.toRotationMatrix();
  state::part(J, position, attitude) = R * so3::skew(fix.p_b_a);
  state::part(J, velocity, attitude) = R * so3::skew(omega_b.cross(fix.p_b_a));
  state::NodeMatrix S = state::NodeMatrix::Zero();
  state::part(S, position, position) = fix.position_covariance;
  state::part(S, velocity, velocity) = velocity_covariance;
  state::part(S, attitude, attitude) = b_by_euler * variance.asDiagonal() * b_by_euler.transpose();
  state::part(S, gyro_bias, gyro_bias) = gyro_sigma * gyro_sigma * Matrix3d::Identity();
  state::part(S, accel_bias, accel_bias) = accel_sigma * accel_sigma * Matrix3d::Identity();
  epoch.covariance = J * S * J.transpose();
  return epoch;
}

}  // namespace foucault::alignment
