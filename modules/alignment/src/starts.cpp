#include "starts.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/imu/recent_rates.h"
#include "motion_fit.h"

namespace foucault::alignment {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRestSpeedSigma = 0.01;  // [m/s]
/// Measurements that are used again in the run have their variances doubled.
constexpr double kDoubled = 2;
constexpr double kForceSigma = 0.05;  // [m/s^2]: what latency and changing forces leave
constexpr double kUnknownRate = 1;    // [rad/s]

/// Increments from one stamp to another.
template <class Use>
void for_each_increment(const std::deque<Step>& steps, int64_t from_ns, int64_t to_ns,
                        const Use& use) {
  for (const Step& step : steps) {
    const auto* increment = std::get_if<ImuIncrement>(&step);
    if (!increment || increment->t_begin_ns < from_ns) continue;
    if (increment->t_end_ns > to_ns) return;
    use(*increment);
  }
}

}  // namespace

AlignmentFindings findings_at_rest(const RestMeans& means, const GnssFix& fix,
                                   const imu::ImuNoise& noise, const Quaterniond& q_v_b) {
  AlignmentFindings findings;
  findings.fix = fix;
  findings.q_v_b = q_v_b;
  findings.motion_covariance.topLeftCorner<3, 3>() =
      kRestSpeedSigma * kRestSpeedSigma * Matrix3d::Identity();
  const double T = means.duration();
  const double accel_white = noise.accel_noise_density * noise.accel_noise_density / T;
  const double gyro_white = noise.gyro_noise_density * noise.gyro_noise_density / T;
  findings.specific_force_b = means.accel_b;
  findings.specific_force_covariance =
      (kDoubled * means.accel_variance.cwiseMax(accel_white)).asDiagonal();
  findings.gyro_b = means.gyro_b;
  findings.gyro_covariance = (kDoubled * means.gyro_variance.cwiseMax(gyro_white)).asDiagonal();
  return findings;
}

AlignmentFindings findings_in_motion(const std::vector<GnssFix>& fixes,
                                     const std::deque<Step>& steps, const imu::ImuNoise& noise,
                                     const Quaterniond& q_v_b) {
  const MotionFit motion = fit_motion(fixes);
  const Vector3d& lever = fixes.front().p_b_a;
  Quaterniond q_begin_b = Quaterniond::Identity();
  Vector3d sum = Vector3d::Zero(), swing_begin = Vector3d::Zero();
  imu::RecentRates rates{imu::kLeverArmRateMemory};
  AlignmentFindings findings;
  double duration = 0;
  for_each_increment(steps, fixes.front().t_ns, fixes.back().t_ns, [&](const ImuIncrement& inc) {
    rates.add(inc);
    duration += inc.dt();
    if (duration <= imu::kLeverArmRateMemory || findings.omega_b.isZero()) {
      findings.omega_b = rates.gyro_b;
      swing_begin = findings.omega_b.cross(lever);
    }
    sum += q_begin_b * (so3::exp(0.5 * inc.dtheta_b) * inc.dvel_b);
    q_begin_b = (q_begin_b * so3::exp(inc.dtheta_b)).normalized();
  });
  findings.fix = fixes.front();
  findings.q_v_b = q_v_b;
  findings.antenna_velocity_n = motion.begin_velocity_n;
  findings.acceleration_n = motion.acceleration_n;
  findings.motion_covariance = motion.covariance;
  const Vector3d swing = q_begin_b * rates.gyro_b.cross(lever) - swing_begin;
  findings.specific_force_b = (sum + swing) / duration;
  const double bias_sigma = std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma);
  const double turned = bias_sigma * duration / 2 * findings.specific_force_b.norm();
  const double force_sigma =
      std::hypot(kForceSigma, noise.accel_noise_density / std::sqrt(duration), turned);
  findings.specific_force_covariance = force_sigma * force_sigma * Matrix3d::Identity();
  findings.gyro_covariance = kUnknownRate * kUnknownRate * Matrix3d::Identity();
  return findings;
}

CarriedBack carried_back(const state::Epoch& found, const std::deque<Step>& steps, int64_t to_ns,
                         const imu::ImuNoise& noise) {
  Quaterniond B = Quaterniond::Identity();
  Matrix3d integral = Matrix3d::Zero();
  double T = 0;
  for_each_increment(steps, to_ns, found.t_ns, [&](const ImuIncrement& increment) {
    const Quaterniond turn = so3::exp(increment.dtheta_b - found.bias.gyro * increment.dt());
    B = (B * turn).normalized();
    integral += B.toRotationMatrix() * increment.dt();
    T += increment.dt();
  });
  const Vector3d earth = geodesy::wgs84::earth_rate_n(found.position.latitude) * T;
  CarriedBack back;
  back.q_n_b = (so3::exp(earth) * found.q_n_b * B.conjugate()).normalized();
  back.bias = found.bias;
  Eigen::Matrix<double, 9, 9> J = Eigen::Matrix<double, 9, 9>::Identity();
  J.block<3, 3>(0, 0) = B.toRotationMatrix();
  J.block<3, 3>(0, 3) = integral;
  back.covariance = J * found.covariance.block<9, 9>(6, 6) * J.transpose();
  back.covariance.topLeftCorner<3, 3>() +=
      noise.gyro_noise_density * noise.gyro_noise_density * T * Matrix3d::Identity();
  return back;
}

/// The sum of (q, biases) as found, with `factor` times their covariance, and of the prior (0,
/// sigma^2) of each bias, as far as it is not in them already.
void CarriedBack::reuse(double factor, const imu::ImuNoise& noise) {
  using Vector9d = Eigen::Matrix<double, 9, 1>;
  covariance *= factor;
  Vector9d change = Vector9d::Zero();
  const auto know = [&](int row, double value, double sigma) {
    const double variance = factor / (factor - 1) * sigma * sigma;
    const Vector9d K = covariance.col(row) / (covariance(row, row) + variance);
    change += K * (-value - change[row]);
    covariance -= (K * covariance.row(row)).eval();
  };
  for (int axis = 0; axis < 3; ++axis) {
    know(3 + axis, bias.gyro[axis], std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma));
    know(6 + axis, bias.accel[axis], std::hypot(noise.accel_turn_on_sigma, noise.accel_bias_sigma));
  }
  q_n_b = q_n_b * so3::exp(change.head<3>());
  bias.gyro += change.segment<3>(3);
  bias.accel += change.tail<3>();
}

namespace {

struct Velocity {
  Vector3d value_n = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();
};

/// Of the antenna at the first fix.
Velocity velocity_at_first(const std::vector<GnssFix>& fixes, const std::deque<Step>& steps,
                           const CarriedBack& found, const Vector3d& omega_b) {
  const GnssFix& first = fixes.front();
  Velocity best;
  best.covariance = 1e4 * Matrix3d::Identity();
  if (first.velocity_n && first.velocity_covariance.allFinite() &&
      first.velocity_covariance.diagonal().minCoeff() > 0) {
    best = {*first.velocity_n, first.velocity_covariance};
  }
  const geodesy::LocalFrame frame(first.antenna);
  const double gravity =
      geodesy::wgs84::normal_gravity(first.antenna.latitude, first.antenna.height);
  const Vector3d earth_rate = geodesy::wgs84::earth_rate_n(first.antenna.latitude);
  const Matrix3d level = found.covariance.topLeftCorner<3, 3>();
  const double tilt_variance =
      gravity * gravity * level.trace() + found.covariance.diagonal().tail<3>().maxCoeff();
  Quaterniond q = found.q_n_b;
  Vector3d way = Vector3d::Zero(), speed = Vector3d::Zero();
  double T = 0;
  std::size_t next = 1;
  for_each_increment(steps, first.t_ns, fixes.back().t_ns, [&](const ImuIncrement& inc) {
    const double dt = inc.dt();
    const Vector3d turn = inc.dtheta_b - found.bias.gyro * dt;
    const Vector3d dv = q * (so3::exp(0.5 * turn) * (inc.dvel_b - found.bias.accel * dt)) +
                        Vector3d(0, 0, gravity * dt);
    way += speed * dt + 0.5 * dv * dt;
    speed += dv;
    q = (so3::exp(-earth_rate * dt) * q * so3::exp(turn)).normalized();
    T += dt;
    if (next == fixes.size() || inc.t_end_ns < fixes[next].t_ns) return;
    const GnssFix& fix = fixes[next++];
    const double by_tilt = tilt_variance * T * T / 4;
    const Matrix3d covariance = (first.position_covariance + fix.position_covariance) / (T * T) +
                                by_tilt * Matrix3d::Identity();
    if (covariance.trace() > best.covariance.trace()) return;
    const Vector3d chord_n =
        frame.to_local(fix.antenna) - (q * fix.p_b_a - found.q_n_b * first.p_b_a);
    const Vector3d coriolis = earth_rate.cross(chord_n);  // 2 w x v, integrated twice
    best = {(chord_n - way + coriolis * T) / T + found.q_n_b * omega_b.cross(first.p_b_a),
            covariance};
  });
  return best;
}

}  // namespace

state::Epoch state_in_motion(const std::vector<GnssFix>& fixes, const std::deque<Step>& steps,
                             const CarriedBack& found) {
  const GnssFix& first = fixes.front();
  imu::RecentRates rates{imu::kLeverArmRateMemory};
  for_each_increment(steps, first.t_ns, first.t_ns + nanoseconds(imu::kLeverArmRateMemory),
                     [&](const ImuIncrement& increment) { rates.add(increment); });
  const Vector3d omega_b = rates.gyro_b - found.bias.gyro;
  const Velocity velocity = velocity_at_first(fixes, steps, found, omega_b);
  state::Epoch epoch;
  epoch.q_n_b = found.q_n_b;
  epoch.bias = found.bias;
  place_at_imu(epoch, first, velocity.value_n, omega_b);
  state::NodeMatrix S = state::NodeMatrix::Zero();
  state::part(S, state::block::position, state::block::position) = first.position_covariance;
  state::part(S, state::block::velocity, state::block::velocity) = kDoubled * velocity.covariance;
  S.block<9, 9>(6, 6) = found.covariance;
  state::NodeMatrix J = state::NodeMatrix::Identity();
  const Matrix3d R = epoch.q_n_b.toRotationMatrix();
  state::part(J, state::block::position, state::block::attitude) = R * so3::skew(first.p_b_a);
  state::part(J, state::block::velocity, state::block::attitude) =
      R * so3::skew(omega_b.cross(first.p_b_a));
  epoch.covariance = J * S * J.transpose();
  return epoch;
}

}  // namespace foucault::alignment
