#include "moving_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

constexpr double kDegree = 0.0174532925199;
constexpr double kShortest = 3.9;               // [s]
constexpr double kLongest = 10.1;               // [s]
constexpr std::ptrdiff_t kFewestFixes = 4;      // of 3 parameters an axis
constexpr double kLatency = 0.1;                // [s]: velocities lag, IMU stamps are late
constexpr double kForceSigma = 0.05;            // [m/s^2]: what latency and changing forces leave
constexpr double kLevelChange = 1.0 * kDegree;  // of roll and pitch over a stretch
constexpr double kSmallestHeadingSigma = 0.3 * kDegree;
constexpr double kSideslipArm = 1.5;  // [m], see CourseFinder
constexpr double kLargestLevelSigma = 3 * kDegree;

/// Normal equations of one observation z = A x + noise(C), with x = [p v a].
struct NormalEquations {
  Matrix9d information = Matrix9d::Zero();
  Vector9d vector = Vector9d::Zero();
  double squares = 0;
  int observations = 0;

  void add(const Eigen::Matrix<double, 3, 9>& A, const Vector3d& z, const Matrix3d& covariance) {
    const Matrix3d weight = covariance.inverse();
    information += A.transpose() * weight * A;
    vector += A.transpose() * weight * z;
    squares += z.dot(weight * z);
    observations += 3;
  }
};

void add_fix(NormalEquations& equations, const GnssFix& fix, const LocalFrame& frame,
             int64_t end_ns) {
  const double t = seconds_between(end_ns, fix.t_ns);
  Eigen::Matrix<double, 3, 9> A;
  A << Matrix3d::Identity(), t * Matrix3d::Identity(), 0.5 * t * t * Matrix3d::Identity();
  equations.add(A, frame.to_local(fix.antenna), fix.position_covariance);
  const bool coarse = horizontal_sigma(fix.position_covariance) > kPreciseSigma;
  if (!coarse || !fix.velocity_n) return;
  A << Matrix3d::Zero(), Matrix3d::Identity(), t * Matrix3d::Identity();
  equations.add(A, *fix.velocity_n, fix.velocity_covariance);
}

Vector3d mean_rate(const std::deque<ImuIncrement>& increments, int64_t begin_ns) {
  Vector3d sum = Vector3d::Zero();
  double duration = 0;
  for (const ImuIncrement& increment : increments) {
    if (increment.t_begin_ns < begin_ns) continue;
    sum += increment.dtheta_b;
    duration += increment.dt();
  }
  return sum / duration;
}

}  // namespace

std::optional<MotionFit> fit_motion(std::deque<GnssFix>::const_iterator first,
                                    std::deque<GnssFix>::const_iterator last) {
  const GnssFix& end = *std::prev(last);
  const LocalFrame frame(end.antenna);
  NormalEquations equations;
  for (auto fix = first; fix != last; ++fix) add_fix(equations, *fix, frame, end.t_ns);
  const int freedom = equations.observations - 9;
  const Eigen::LDLT<Matrix9d> ldlt(equations.information);
  if (freedom < 1 || ldlt.info() != Eigen::Success || !ldlt.isPositive()) return std::nullopt;

  const Vector9d x = ldlt.solve(equations.vector);
  const double misfit = std::max(0.0, equations.squares - x.dot(equations.vector)) / freedom;
  const Matrix9d covariance = std::max(1.0, misfit) * ldlt.solve(Matrix9d::Identity());
  if (!x.allFinite() || !covariance.allFinite()) return std::nullopt;
  MotionFit fit;
  fit.duration = seconds_between(first->t_ns, end.t_ns);
  fit.velocity_n = x.segment<3>(3);
  fit.acceleration_n = x.segment<3>(6);
  fit.begin_velocity_n = fit.velocity_n - fit.duration * fit.acceleration_n;
  fit.covariance = covariance.bottomRightCorner<6, 6>();
  fit.covariance.topLeftCorner<3, 3>() +=
      kLatency * kLatency * fit.acceleration_n * fit.acceleration_n.transpose();
  return fit;
}

MovingAlignment::MovingAlignment(const CourseLimits& limits,
                                 const std::optional<GivenAngle>& given_heading,
                                 const Quaterniond& q_v_b, const ImuNoise& noise)
    : limits_(limits), given_heading_(given_heading), q_v_b_(q_v_b), noise_(noise) {}

void MovingAlignment::restart() {
  fixes_.clear();
  increments_.clear();
}

void MovingAlignment::add(const ImuIncrement& increment) {
  increments_.push_back(increment);
  const int64_t earliest_ns = increment.t_end_ns - nanoseconds(kLongest);
  while (increments_.front().t_begin_ns < earliest_ns) increments_.pop_front();
}

std::optional<AlignmentFindings> MovingAlignment::add(const GnssFix& fix) {
  const bool change = !fixes_.empty() && fixes_.back().quality != fix.quality;
  const bool backward = !fixes_.empty() && fix.t_ns <= fixes_.back().t_ns;
  if (change || backward) fixes_.clear();
  fixes_.push_back(fix);
  while (seconds_between(fixes_.front().t_ns, fix.t_ns) > kLongest) fixes_.pop_front();
  if (increments_.empty()) return std::nullopt;

  // Shorter stretches first: the acceleration is more nearly constant over them.
  for (auto first = fixes_.cend(); first != fixes_.cbegin();) {
    --first;
    const bool covered = first->t_ns >= increments_.front().t_begin_ns;
    if (!covered) break;
    if (seconds_between(first->t_ns, fix.t_ns) < kShortest) continue;
    if (std::distance(first, fixes_.cend()) < kFewestFixes) continue;
    std::optional<AlignmentFindings> findings = align(first);
    if (findings) return findings;
  }
  return std::nullopt;
}

std::optional<AlignmentFindings> MovingAlignment::align(std::deque<GnssFix>::const_iterator first) {
  const std::optional<MotionFit> fit = fit_motion(first, fixes_.cend());
  if (!fit) return std::nullopt;
  fastest_ = std::max(fastest_, fit->velocity_n.head<2>().norm());
  if (!straight_and_fast(*fit)) return std::nullopt;

  AlignmentFindings findings;
  findings.fix = fixes_.back();
  findings.q_v_b = q_v_b_;
  findings.antenna_velocity_n = fit->velocity_n;
  findings.acceleration_n = fit->acceleration_n;
  findings.motion_covariance = fit->covariance;
  find_gyro(*fit, first->t_ns, findings);
  Matrix3d bias_covariance;
  const Vector3d bias = bias_estimate(findings, bias_covariance);
  turn_forces_to_the_end(bias, first->t_ns, findings);
  const double turned = std::sqrt(bias_covariance.trace() / 3) * fit->duration / 2;
  const double force_sigma =
      std::hypot(kForceSigma, noise_.accel_noise_density / std::sqrt(fit->duration),
                 turned * findings.specific_force_b.norm());
  findings.specific_force_covariance = force_sigma * force_sigma * Matrix3d::Identity();
  findings.omega_b = findings.gyro_b - bias;
  find_attitude(*fit, findings);
  if (!precise(findings)) return std::nullopt;
  return findings;
}

bool MovingAlignment::straight_and_fast(const MotionFit& fit) const {
  if (given_heading_) return true;
  const double slowest =
      std::min(fit.velocity_n.head<2>().norm(), fit.begin_velocity_n.head<2>().norm());
  const double turned = so3::wrap(azimuth(fit.velocity_n) - azimuth(fit.begin_velocity_n));
  return slowest >= limits_.min_speed && std::abs(turned) <= limits_.max_turn_rate * fit.duration;
}

/// The mean rate, and what of it is no bias: roll and pitch hardly change over a stretch, and the
/// course tells the turn about the vertical.
void MovingAlignment::find_gyro(const MotionFit& fit, int64_t begin_ns,
                                AlignmentFindings& findings) const {
  const double T = fit.duration;
  findings.gyro_b = mean_rate(increments_, begin_ns);
  double turn_rate = 0;
  double course_variance = kLevelChange * kLevelChange;
  if (!given_heading_) {
    turn_rate = so3::wrap(azimuth(fit.velocity_n) - azimuth(fit.begin_velocity_n)) / T;
    const double speed = fit.velocity_n.head<2>().norm();
    course_variance = 2 * fit.covariance.topLeftCorner<2, 2>().trace() / (speed * speed) +
                      kLevelChange * kLevelChange;
  }
  findings.turn_n = Vector3d(0, 0, turn_rate);
  const double white = noise_.gyro_noise_density * noise_.gyro_noise_density / T;
  findings.gyro_covariance =
      (std::max(course_variance, kLevelChange * kLevelChange) / (T * T) + white) *
      Matrix3d::Identity();
}

/// Gyroscope bias good enough to turn the forces within the stretch: the measured one weighed
/// against the prior, or alone if it contradicts the prior.
Vector3d MovingAlignment::bias_estimate(const AlignmentFindings& findings,
                                        Matrix3d& covariance) const {
  const Vector3d down_b = -increments_.back().dvel_b.normalized();
  const Vector3d measured = findings.gyro_b - findings.turn_n.z() * down_b;
  const double measured_variance = findings.gyro_covariance(0, 0);
  const double prior_variance = noise_.gyro_turn_on_sigma * noise_.gyro_turn_on_sigma +
                                noise_.gyro_bias_sigma * noise_.gyro_bias_sigma;
  const bool contradicts = measured.squaredNorm() > 25 * (measured_variance + prior_variance);
  const double weight = contradicts ? 1.0 : prior_variance / (prior_variance + measured_variance);
  covariance = weight * measured_variance * Matrix3d::Identity();
  return weight * measured;
}

/// Mean specific force over the stretch, each increment turned into the last body frame.
void MovingAlignment::turn_forces_to_the_end(const Vector3d& bias, int64_t begin_ns,
                                             AlignmentFindings& findings) const {
  Quaterniond q_end_b = Quaterniond::Identity();
  Vector3d sum = Vector3d::Zero();
  double duration = 0;
  for (auto increment = increments_.crbegin();
       increment != increments_.crend() && increment->t_begin_ns >= begin_ns; ++increment) {
    const Vector3d back = -(increment->dtheta_b - bias * increment->dt());
    sum += q_end_b * (so3::exp(0.5 * back) * increment->dvel_b);
    q_end_b = q_end_b * so3::exp(back);
    duration += increment->dt();
  }
  findings.specific_force_b = sum / duration;
}

/// Heading along the velocity of the IMU, which the lever arm sets off from that of the antenna.
void MovingAlignment::find_attitude(const MotionFit& fit, AlignmentFindings& findings) const {
  if (given_heading_) {
    findings.heading = given_heading_->value;
    findings.heading_variance = given_heading_->sigma * given_heading_->sigma;
    return;
  }
  const double turn_rate = findings.turn_n.z();
  Vector3d velocity_n = fit.velocity_n;
  for (int round = 0; round < 3; ++round) {
    findings.heading = azimuth(velocity_n);
    const Vector3d swing_n = attitude_of(findings) * findings.omega_b.cross(findings.fix.p_b_a);
    velocity_n = fit.velocity_n - swing_n;
  }
  const double speed = velocity_n.head<2>().norm();
  const double sideslip = turn_rate * (kSideslipArm / speed + kLatency);
  findings.heading_variance = kSmallestHeadingSigma * kSmallestHeadingSigma + sideslip * sideslip;
  findings.heading_by_velocity = Vector3d(-velocity_n.y(), velocity_n.x(), 0) / (speed * speed);
}

bool MovingAlignment::precise(const AlignmentFindings& findings) const {
  const Matrix3d velocity = findings.motion_covariance.topLeftCorner<3, 3>();
  const double course_variance =
      findings.heading_by_velocity.dot(velocity * findings.heading_by_velocity);
  const double level_sigma = std::sqrt(findings.motion_covariance.diagonal().tail<3>().maxCoeff()) /
                             findings.specific_force_b.norm();
  return course_variance <= limits_.max_sigma * limits_.max_sigma &&
         level_sigma <= kLargestLevelSigma;
}

}  // namespace foucault
