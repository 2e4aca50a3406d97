#pragma once

#include <Eigen/Core>

#include "foucault/core/measurement.h"

/// The local North-East-Down frame n of a place, in curvilinear coordinates. Units rad, m, s.
/// Source: Groves, "Principles of GNSS, Inertial and Multisensor Integrated Navigation Systems"
/// (2013), ch. 2 and 5.
namespace foucault::geodesy {

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

}  // namespace foucault::geodesy
