#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <variant>

#include "foucault/core/fix_quality.h"

/// The measurements that walk from a source to an estimator, one value type each.
namespace foucault {

/// WGS-84 geodetic coordinates; height above the ellipsoid.
struct Geodetic {
  double latitude = 0;   ///< [rad]
  double longitude = 0;  ///< [rad]
  double height = 0;     ///< [m]
};

/// Integrated angular rate and specific force over (t_begin, t_end], not compensated for biases.
struct ImuIncrement {
  int64_t t_begin_ns = 0;
  int64_t t_end_ns = 0;
  Eigen::Vector3d dtheta_b = Eigen::Vector3d::Zero();  ///< [rad]
  Eigen::Vector3d dvel_b = Eigen::Vector3d::Zero();    ///< [m/s]
  /// White noise beyond the sensor's own, zero unless the increment was made up to bridge a gap.
  double extra_gyro_noise_density = 0;   ///< [rad/s/sqrt(Hz)]
  double extra_accel_noise_density = 0;  ///< [m/s^2/sqrt(Hz)]

  double dt() const { return static_cast<double>(t_end_ns - t_begin_ns) * 1e-9; }  ///< [s]
};

/// What a receiver tells of a fix beside its accuracy.
struct FixDetails {
  std::optional<int> satellites;  ///< used in it
  std::optional<double> hdop;
  std::optional<double> correction_age;  ///< [s]
};

/// Azimuth of the baseline between two antennas, clockwise from North.
struct GnssHeading {
  double azimuth = 0;   ///< [rad]
  double sigma = 0;     ///< [rad]
  double baseline = 0;  ///< told direction of the baseline in v, from forward to the right [rad]
};

/// A GNSS position of the antenna, with velocity and heading where the receiver gives them.
struct GnssFix {
  int64_t t_ns = 0;
  Geodetic antenna;
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();  ///< north, east, down [m^2]
  std::optional<Eigen::Vector3d> velocity_n;                      ///< north, east, down [m/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();  ///< [m^2/s^2]
  std::optional<GnssHeading> heading;
  FixQuality quality = FixQuality::unknown;
  Eigen::Vector3d p_b_a = Eigen::Vector3d::Zero();  ///< lever arm, IMU to antenna, in b [m]
  bool lever_arm_known = true;                      ///< else p_b_a is zero for want of a better one
  double since_first_s = 0;                         ///< for a clock that drifts
  FixDetails details;
};

/// A pose of a reference system, of the IMU centre, on the vehicle's axes.
struct ReferencePose {
  int64_t t_ns = 0;
  Geodetic position;
  std::optional<Eigen::Vector3d> velocity_n;  ///< north, east, down [m/s]
  std::optional<Eigen::Quaterniond> q_n_v;    ///< vehicle (forward-right-down) to local NED
};

/// Speed of the vehicle from its wheels, along v's forward axis.
struct WheelSpeed {
  int64_t t_ns = 0;
  double forward = 0;  ///< [m/s]
};

/// An instant at which the user wants an epoch and nothing is measured: an event mark, or a fix
/// that an outage withholds.
struct EpochRequest {
  int64_t t_ns = 0;
};

/// A stream is ordered by stamp, an increment by its end; at equal stamps increments come last, so
/// that the fix at t is known before the increment that reaches or passes t.
using Measurement = std::variant<GnssFix, EpochRequest, WheelSpeed, ReferencePose, ImuIncrement>;

inline int64_t stamp(const ImuIncrement& m) { return m.t_end_ns; }
template <class M>
int64_t stamp(const M& m) {
  return m.t_ns;
}
inline int64_t stamp(const Measurement& m) {
  return std::visit([](const auto& x) { return stamp(x); }, m);
}

}  // namespace foucault
