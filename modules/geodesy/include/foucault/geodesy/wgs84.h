#pragma once

#include <Eigen/Core>

#include "foucault/core/measurement.h"

/// WGS-84: ellipsoid, normal gravity, Earth rate.
/// Frames: e = ECEF [m]; n = North-East-Down at the given latitude and longitude.
/// Source: NIMA TR8350.2 (2000), chapters 3 and 4.
namespace foucault::geodesy::wgs84 {

constexpr double kSemiMajorAxis = 6378137.0;         ///< a [m]
constexpr double kFlattening = 1.0 / 298.257223563;  ///< f
constexpr double kEarthRate = 7.292115e-5;           ///< omega_ie [rad/s]

/// Radii of curvature in the meridian (M) and the prime vertical (N) [m].
double meridian_radius(double latitude);
double transverse_radius(double latitude);

Eigen::Vector3d geodetic_to_ecef(const Geodetic& position);
/// Exact to a few nanometres within 100 km of the ellipsoid. Longitude in (-pi, pi].
Geodetic ecef_to_geodetic(const Eigen::Vector3d& p_e);

/// n to e: columns north, east, down.
Eigen::Matrix3d R_e_n(double latitude, double longitude);

/// Magnitude of normal gravity [m/s^2] (centrifugal part included): Somigliana on the ellipsoid,
/// second order in height (TR8350.2 (4-1), (4-3)). Good to 1e-7 m/s^2 at 1 km, 3e-6 at 20 km.
double normal_gravity(double latitude, double height);

/// Derivatives of normal_gravity.
struct GravitySlope {
  double by_latitude;  ///< [m/s^2/rad]
  double by_height;    ///< [1/s^2]
};
GravitySlope normal_gravity_slope(double latitude, double height);

/// omega_ie in n [rad/s]. Paper (10).
Eigen::Vector3d earth_rate_n(double latitude);

}  // namespace foucault::geodesy::wgs84
