#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>

#include "foucault/core/measurement.h"
#include "foucault/core/state.h"

/// Strapdown mechanization in the local North-East-Down frame n.
/// Sources: Savage, "Strapdown Inertial Navigation Integration Algorithm Design" (JGCD 1998);
/// Groves, "Principles of GNSS, Inertial and Multisensor Integrated Navigation Systems" (2013),
/// ch. 5; Shin, "Estimation Techniques for Low-Cost Inertial Navigation" (2005), ch. 2.
/// Units rad, m, s.
namespace foucault {

/// Position, velocity and attitude of the IMU centre.
struct StrapdownState {
  int64_t t_ns = 0;
  Geodetic position;
  Eigen::Vector3d v_n = Eigen::Vector3d::Zero();  ///< relative to the Earth, in n [m/s]
  Eigen::Quaterniond q_n_b = Eigen::Quaterniond::Identity();
};

/// What the Earth does to a body at one place; everything that depends on the position alone.
struct Place {
  explicit Place(const Geodetic& position);

  double radius_north;  ///< M + h: metres per radian of latitude
  double radius_east;   ///< N + h
  double cos_latitude;
  double tan_latitude;
  double gravity;              ///< normal gravity, along down [m/s^2]
  Eigen::Vector3d omega_ie_n;  ///< [rad/s]

  /// Rate of n relative to e by the motion over the ellipsoid [rad/s]. Groves (5.44).
  Eigen::Vector3d omega_en_n(const Eigen::Vector3d& v_n) const;

  /// Gravity minus Coriolis acceleration [m/s^2]: what v_n changes by besides specific force.
  Eigen::Vector3d free_acceleration_n(const Eigen::Vector3d& v_n) const;
};

/// The position d_n [m] north, east, down of `position`, in steps along the ellipsoid with the
/// radii of `place`. Longitude in (-pi, pi]. Not for the poles.
Geodetic displaced(const Geodetic& position, const Eigen::Vector3d& d_n, const Place& place);

/// Its inverse: north, east, down [m] from `from` to `to`, over +-180 deg if that is shorter.
Eigen::Vector3d displacement_n(const Geodetic& from, const Geodetic& to, const Place& place);

/// Position, velocity, attitude of an error state: the first nine of its rows.
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// The state with an error put right: dp in metres along the ellipsoid, attitude on the right.
StrapdownState corrected(const StrapdownState& state, const Vector9d& error);

/// The error of which `to` is the corrected `from`, positions by the radii of `from`.
Vector9d difference(const StrapdownState& from, const StrapdownState& to);

/// The increment without the biases' share.
ImuIncrement without_bias(const ImuIncrement& increment, const ImuBias& bias);

/// The state at the end of an increment which begins at state.t_ns.
/// Both increments are free of biases. `previous` is the one before, for coning and sculling;
/// a default one (of no length) when there is none.
/// Second order in dt: rates of the Earth, Coriolis and gravity are those of mid-interval, the
/// position follows the mean velocity.
StrapdownState advance(const StrapdownState& state, const ImuIncrement& previous,
                       const ImuIncrement& increment);

}  // namespace foucault
