#include "motion_fit.h"

#include <array>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::alignment {

namespace {

using Eigen::Vector3d;

constexpr double kJerk = 1.0;               // density of a car's jerk [m/s^3/sqrt(Hz)]
constexpr double kUnknownVelocity = 100;    // [m/s]
constexpr double kUnknownAcceleration = 3;  // [m/s^2]

/// One axis of the antenna's motion: position, velocity, acceleration, velocity at the first fix.
struct AxisFilter {
  Eigen::Vector4d x = Eigen::Vector4d::Zero();
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();

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
    x += K * innovation;
    const Eigen::Matrix4d I_KH =
        Eigen::Matrix4d::Identity() - K * Eigen::Vector4d::Unit(component).transpose();
    P = I_KH * P * I_KH.transpose() + variance * K * K.transpose();
  }
};

}  // namespace

bool velocity_is_better(const GnssFix& fix) {
  return fix.velocity_n && fix.velocity_covariance.allFinite() &&
         fix.velocity_covariance.diagonal().minCoeff() > 0 &&
         geodesy::horizontal_sigma(fix.position_covariance) > geodesy::kPreciseSigma;
}

MotionFit fit_motion(const std::vector<GnssFix>& fixes) {
  const geodesy::LocalFrame frame(fixes.front().antenna);
  std::array<AxisFilter, 3> axes{AxisFilter(fixes.front().position_covariance(0, 0)),
                                 AxisFilter(fixes.front().position_covariance(1, 1)),
                                 AxisFilter(fixes.front().position_covariance(2, 2))};
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const GnssFix& fix = fixes[i];
    const Vector3d position = frame.to_local(fix.antenna);
    for (int axis = 0; axis < 3; ++axis) {
      if (i > 0) {
        axes[axis].predict(seconds_between(fixes[i - 1].t_ns, fix.t_ns));
        axes[axis].update(0, position[axis], fix.position_covariance(axis, axis));
      }
      if (velocity_is_better(fix))
        axes[axis].update(1, (*fix.velocity_n)[axis], fix.velocity_covariance(axis, axis));
    }
  }
  MotionFit fit;
  fit.duration = seconds_between(fixes.front().t_ns, fixes.back().t_ns);
  for (int axis = 0; axis < 3; ++axis) {
    fit.velocity_n[axis] = axes[axis].x[1];
    fit.begin_velocity_n[axis] = axes[axis].x[3];
    Eigen::Matrix<double, 2, 4> J;  // begin velocity and mean acceleration by the axis' state
    J << 0, 0, 0, 1, 0, 1 / fit.duration, 0, -1 / fit.duration;
    const Eigen::Matrix2d P = J * axes[axis].P * J.transpose();
    fit.covariance(axis, axis) = P(0, 0);
    fit.covariance(axis, axis + 3) = fit.covariance(axis + 3, axis) = P(0, 1);
    fit.covariance(axis + 3, axis + 3) = P(1, 1);
  }
  fit.acceleration_n = (fit.velocity_n - fit.begin_velocity_n) / fit.duration;
  fit.covariance.topLeftCorner<3, 3>() +=
      kVelocityLatency * kVelocityLatency * fit.acceleration_n * fit.acceleration_n.transpose();
  return fit;
}

MotionLine fit_line(const std::vector<GnssFix>& fixes) {
  const geodesy::LocalFrame frame(fixes.front().antenna);
  double weights = 0, t_sum = 0, tt_sum = 0;
  Eigen::Vector2d p_sum(0, 0), tp_sum(0, 0), velocity_sum(0, 0);
  double velocity_weights = 0;
  for (const GnssFix& fix : fixes) {
    const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
    const double w = 1 / (sigma * sigma), t = seconds_between(fixes.front().t_ns, fix.t_ns);
    const Eigen::Vector2d p = frame.to_local(fix.antenna).head<2>();
    weights += w;
    t_sum += w * t;
    tt_sum += w * t * t;
    p_sum += w * p;
    tp_sum += w * t * p;
    if (!velocity_is_better(fix)) continue;
    const double sigma_v = geodesy::horizontal_sigma(fix.velocity_covariance);
    velocity_weights += 1 / (sigma_v * sigma_v);
    velocity_sum += fix.velocity_n->head<2>() / (sigma_v * sigma_v);
  }
  const double spread = tt_sum - t_sum * t_sum / weights;
  const double information = spread + velocity_weights;
  MotionLine line;
  line.velocity_n = (tp_sum - t_sum / weights * p_sum + velocity_sum) / information;
  line.sigma = 1 / std::sqrt(information);
  return line;
}

}  // namespace foucault::alignment
