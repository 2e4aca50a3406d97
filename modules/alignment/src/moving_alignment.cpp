#include "moving_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kShortest = 3.9;               // [s]
constexpr double kLongest = 10.1;               // [s]
constexpr std::ptrdiff_t kFewestFixes = 4;      // of 3 parameters an axis
constexpr double kLatency = 0.1;                // [s]: velocities lag, IMU stamps are late
constexpr double kForceSigma = 0.05;            // [m/s^2]: what latency and changing forces leave
constexpr double kLevelChange = 1.0 * kDegree;  // of roll and pitch over a stretch
constexpr double kLargestLevelSigma = 3 * kDegree;
constexpr double kLargestExcess = 0.5;      // [m/s^2], of the specific force's length
constexpr double kWorstInnovations = 9;     // mean square over sigma
constexpr double kJerk = 1.0;               // density of a car's jerk [m/s^3/sqrt(Hz)]
constexpr double kUnknownVelocity = 100;    // [m/s]
constexpr double kUnknownAcceleration = 3;  // [m/s^2]
constexpr double kSteadyTurn = 0.5;         // [s]: shorter steps say nothing about a turn

/// One axis of the antenna's motion: position, velocity, acceleration, velocity at the first fix.
struct AxisFilter {
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  double squares = 0;
  int observations = 0;

  explicit AxisFilter(double position_variance) {
    const double v = kUnknownVelocity * kUnknownVelocity;
    P.diagonal() << position_variance, v, kUnknownAcceleration * kUnknownAcceleration, v;
    P(1, 3) = P(3, 1) = v;
  }

  /// Acceleration as a random walk: jerk is white noise of density kJerk.
  void predict(double dt) {
    Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
    F(0, 1) = dt;
    F(0, 2) = dt * dt / 2;
    F(1, 2) = dt;
    const double q = kJerk * kJerk, dt2 = dt * dt, dt3 = dt2 * dt;
    Eigen::Matrix3d Q;
    Q << dt3 * dt2 / 20, dt2 * dt2 / 8, dt3 / 6,  //
        dt2 * dt2 / 8, dt3 / 3, dt2 / 2,          //
        dt3 / 6, dt2 / 2, dt;
    x = F * x;
    P = F * P * F.transpose();
    P.topLeftCorner<3, 3>() += q * Q;
  }

  void update(int component, double value, double variance) {
    const double S = P(component, component) + variance;
    const double innovation = value - x[component];
    const Eigen::Vector4d K = P.col(component) / S;
    squares += innovation * innovation / S;
    ++observations;
    x += K * innovation;
    const Eigen::Matrix4d I_KH =
        Eigen::Matrix4d::Identity() - K * Eigen::Vector4d::Unit(component).transpose();
    P = I_KH * P * I_KH.transpose() + variance * K * K.transpose();
  }
};

/// Three axes, and how the course turns along the way.
struct MotionFilter {
  std::array<AxisFilter, 3> axes;
  int fixes = 0;
  double fastest_turn = 0;

  explicit MotionFilter(const GnssFix& first)
      : axes{AxisFilter(first.position_covariance(0, 0)),
             AxisFilter(first.position_covariance(1, 1)),
             AxisFilter(first.position_covariance(2, 2))} {
    use_velocity(first);
  }

  Vector3d component(int i) const { return {axes[0].x[i], axes[1].x[i], axes[2].x[i]}; }

  void add(const GnssFix& fix, const Vector3d& position, double dt) {
    const double course = geodesy::azimuth(component(1));
    for (int axis = 0; axis < 3; ++axis) {
      axes[axis].predict(dt);
      axes[axis].update(0, position[axis], fix.position_covariance(axis, axis));
    }
    use_velocity(fix);
    if (++fixes < 2) return;  // the first course is arbitrary
    const double turned = so3::wrap(geodesy::azimuth(component(1)) - course);
    fastest_turn = std::max(fastest_turn, std::abs(turned) / std::max(dt, kSteadyTurn));
  }

  void use_velocity(const GnssFix& fix) {
    const bool coarse = geodesy::horizontal_sigma(fix.position_covariance) > geodesy::kPreciseSigma;
    if (!coarse || !fix.velocity_n) return;
    for (int axis = 0; axis < 3; ++axis) {
      axes[axis].update(1, (*fix.velocity_n)[axis], fix.velocity_covariance(axis, axis));
    }
  }
};

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

MotionFit fit_motion(std::deque<GnssFix>::const_iterator first,
                     std::deque<GnssFix>::const_iterator last) {
  const geodesy::LocalFrame frame(first->antenna);
  MotionFilter filter(*first);
  for (auto fix = std::next(first); fix != last; ++fix) {
    filter.add(*fix, frame.to_local(fix->antenna),
               seconds_between(std::prev(fix)->t_ns, fix->t_ns));
  }
  MotionFit fit;
  fit.duration = seconds_between(first->t_ns, std::prev(last)->t_ns);
  fit.fastest_turn = filter.fastest_turn;
  fit.velocity_n = filter.component(1);
  fit.begin_velocity_n = filter.component(3);
  fit.acceleration_n = (fit.velocity_n - fit.begin_velocity_n) / fit.duration;
  double squares = 0;
  int observations = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Matrix<double, 2, 4> J;  // velocity and mean acceleration by the axis' state
    J << 0, 1, 0, 0, 0, 1 / fit.duration, 0, -1 / fit.duration;
    const Eigen::Matrix2d P = J * filter.axes[axis].P * J.transpose();
    fit.covariance(axis, axis) = P(0, 0);
    fit.covariance(axis, axis + 3) = fit.covariance(axis + 3, axis) = P(0, 1);
    fit.covariance(axis + 3, axis + 3) = P(1, 1);
    squares += filter.axes[axis].squares;
    observations += filter.axes[axis].observations;
  }
  fit.covariance.topLeftCorner<3, 3>() +=
      kLatency * kLatency * fit.acceleration_n * fit.acceleration_n.transpose();
  fit.innovation_ratio = squares / observations;
  return fit;
}

MovingAlignment::MovingAlignment(const CourseLimits& limits,
                                 const std::optional<GivenAngle>& given_heading,
                                 const Quaterniond& q_v_b, const imu::ImuNoise& noise)
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

  // The shortest stretch that is good enough.
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
  const MotionFit fit = fit_motion(first, fixes_.cend());
  fastest_ = std::max(fastest_, fit.velocity_n.head<2>().norm());
  if (fit.innovation_ratio > kWorstInnovations || !straight_and_fast(fit)) return std::nullopt;

  AlignmentFindings findings;
  findings.fix = fixes_.back();
  findings.q_v_b = q_v_b_;
  findings.antenna_velocity_n = fit.velocity_n;
  findings.acceleration_n = fit.acceleration_n;
  findings.motion_covariance = fit.covariance;
  find_gyro(fit, first->t_ns, findings);
  Matrix3d bias_covariance;
  const Vector3d bias = bias_estimate(findings, bias_covariance);
  turn_forces_to_the_end(bias, first->t_ns, findings);
  const double turned = std::sqrt(bias_covariance.trace() / 3) * fit.duration / 2;
  const double force_sigma =
      std::hypot(kForceSigma, noise_.accel_noise_density / std::sqrt(fit.duration),
                 turned * findings.specific_force_b.norm());
  findings.specific_force_covariance = force_sigma * force_sigma * Matrix3d::Identity();
  findings.omega_b = findings.gyro_b - bias;
  find_attitude(fit, findings);
  if (!credible(findings)) return std::nullopt;
  return findings;
}

bool MovingAlignment::straight_and_fast(const MotionFit& fit) const {
  if (given_heading_) return true;
  const double slowest =
      std::min(fit.velocity_n.head<2>().norm(), fit.begin_velocity_n.head<2>().norm());
  const double turned =
      so3::wrap(geodesy::azimuth(fit.velocity_n) - geodesy::azimuth(fit.begin_velocity_n));
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
    turn_rate =
        so3::wrap(geodesy::azimuth(fit.velocity_n) - geodesy::azimuth(fit.begin_velocity_n)) / T;
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
    findings.heading = geodesy::azimuth(velocity_n);
    const Vector3d swing_n = attitude_of(findings) * findings.omega_b.cross(findings.fix.p_b_a);
    velocity_n = fit.velocity_n - swing_n;
  }
  const double speed = velocity_n.head<2>().norm();
  const double sideslip = turn_rate * (kSideslipArm / speed + kLatency);
  findings.heading_variance = limits_.mounting_sigma * limits_.mounting_sigma + sideslip * sideslip;
  findings.heading_by_velocity = Vector3d(-velocity_n.y(), velocity_n.x(), 0) / (speed * speed);
}

/// Precise enough, and the two sensors agree about the length of the specific force.
bool MovingAlignment::credible(const AlignmentFindings& findings) const {
  const Matrix3d velocity = findings.motion_covariance.topLeftCorner<3, 3>();
  const double course_variance =
      findings.heading_by_velocity.dot(velocity * findings.heading_by_velocity);
  const double acceleration_sigma =
      std::sqrt(findings.motion_covariance.diagonal().tail<3>().maxCoeff());
  const double excess = findings.specific_force_b.norm() - specific_force_n(findings).norm();
  return course_variance <= limits_.max_sigma * limits_.max_sigma &&
         acceleration_sigma <= kLargestLevelSigma * findings.specific_force_b.norm() &&
         std::abs(excess) <= kLargestExcess + 3 * acceleration_sigma;
}

}  // namespace foucault::alignment
