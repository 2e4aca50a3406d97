#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/simulation/spline.h"

namespace foucault::simulation {

/// True motion of the IMU centre at one instant.
/// Frames: e ECEF, n North-East-Down of the place, v vehicle (forward-right-down), i inertial.
struct Motion {
  Geodetic position;
  Eigen::Vector3d p_e;         ///< [m]
  Eigen::Vector3d velocity_n;  ///< relative to the Earth [m/s]
  Eigen::Quaterniond q_n_v;
  Eigen::Vector3d omega_iv_v;  ///< angular rate relative to i [rad/s]
  Eigen::Vector3d f_v;         ///< specific force [m/s^2]
};

/// Velocity relative to the Earth, in the NED of the IMU, of a point of the vehicle [m/s].
/// p_v_x: IMU to the point, in v [m].
Eigen::Vector3d point_velocity_n(const Motion& motion, const Eigen::Vector3d& p_v_x);

/// For which options tell what of a vibration goes by the speed [m/s].
inline constexpr double kVibrationSpeed = 15;

/// A vibration on top of the motion: sines of one frequency, a quarter of a period apart from axis
/// to axis, so that the angles cone and position and angles scull. It may grow with time.
struct Vibration {
  double frequency_hz = 0;
  double position_amplitude = 0;  ///< each axis of w [m]
  double angle_amplitude = 0;     ///< roll, pitch and heading [rad]
  /// x: both amplitudes are 1 + so many times as large.
  std::optional<QuinticSpline> growth;
};

/// Closed-form motion over the rotating WGS-84 ellipsoid, C4 in position and attitude: splines
/// of the position in the Cartesian North-East-Down frame w of the start, and of roll, pitch and
/// heading in the NED of the place. The splines are the truth: velocity, angular rate and specific
/// force are their analytic derivatives,
///   f_v = R_v_e (a_e + 2 omega_ie x v_e) - R_v_n g_n,   g_n = normal gravity along down,
///   omega_iv_v = R_v_n (omega_ie_n + omega_en_n) + E(euler) d(euler)/dt.
/// Not defined at the poles, where North is not.
class Trajectory {
 public:
  /// `position_w` [m]; `euler` (roll, pitch, heading) [rad], the heading without jumps.
  Trajectory(const Geodetic& origin, QuinticSpline position_w, QuinticSpline euler,
             Vibration vibration = {});

  /// t [s] since the start, in [0, duration()].
  Motion at(double t) const;

  /// The same without the vibration, which is of the IMU and its mount, not of the wheels.
  Motion steady_at(double t) const;

  double duration() const { return position_w_.duration(); }  ///< [s]

 private:
  QuinticSpline::Sample position_at(double t) const;
  QuinticSpline::Sample euler_at(double t) const;
  void vibrate(QuinticSpline::Sample& sample, double amplitude, double t) const;
  Motion motion_of(const QuinticSpline::Sample& position, const QuinticSpline::Sample& euler) const;

  Eigen::Vector3d origin_e_;
  Eigen::Matrix3d R_e_w_;
  QuinticSpline position_w_;
  QuinticSpline euler_;
  Vibration vibration_;
};

}  // namespace foucault::simulation
