#include "foucault/geodesy/wgs84.h"

#include <cmath>

#include "foucault/core/so3.h"

namespace foucault::geodesy::wgs84 {
namespace {

constexpr double kSemiMinorAxis = kSemiMajorAxis * (1 - kFlattening);
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);
constexpr double kSecondEccentricity2 = kEccentricity2 / (1 - kEccentricity2);

constexpr double kEquatorGravity = 9.7803253359;    // gamma_e [m/s^2]
constexpr double kSomigliana = 0.00193185265241;    // k
constexpr double kGravityRatio = 0.00344978650684;  // m = omega^2 a^2 b / GM

/// Somigliana's formula; s2 is sin^2 of the latitude.
double gravity_on_ellipsoid(double s2) {
  return kEquatorGravity * (1 + kSomigliana * s2) / std::sqrt(1 - kEccentricity2 * s2);
}

/// What gravity loses per h / a, in first order.
double height_factor(double s2) {
  return 2 * (1 + kFlattening + kGravityRatio - 2 * kFlattening * s2);
}

}  // namespace

double meridian_radius(double latitude) {
  const double s = std::sin(latitude);
  const double w2 = 1 - kEccentricity2 * s * s;
  return kSemiMajorAxis * (1 - kEccentricity2) / (w2 * std::sqrt(w2));
}

double transverse_radius(double latitude) {
  const double s = std::sin(latitude);
  return kSemiMajorAxis / std::sqrt(1 - kEccentricity2 * s * s);
}

Eigen::Vector3d geodetic_to_ecef(const Geodetic& position) {
  const double s = std::sin(position.latitude);
  const double N = transverse_radius(position.latitude);
  const double from_axis = (N + position.height) * std::cos(position.latitude);
  return {from_axis * std::cos(position.longitude), from_axis * std::sin(position.longitude),
          (N * (1 - kEccentricity2) + position.height) * s};
}

Geodetic ecef_to_geodetic(const Eigen::Vector3d& p_e) {
  const double p = std::hypot(p_e.x(), p_e.y());
  // Bowring's iteration on the reduced latitude (beta); each step gains a factor of about
  // e^4 h / a, so two are exact to rounding within 100 km and the third serves higher places.
  const int steps = p_e.norm() < kSemiMajorAxis + 1e5 ? 2 : 3;
  double beta = std::atan2(p_e.z() * kSemiMajorAxis, p * kSemiMinorAxis);
  double latitude = 0;
  for (int i = 0; i < steps; ++i) {
    if (i > 0) beta = std::atan2((1 - kFlattening) * std::sin(latitude), std::cos(latitude));
    const double s = std::sin(beta);
    const double c = std::cos(beta);
    latitude = std::atan2(p_e.z() + kSecondEccentricity2 * kSemiMinorAxis * s * s * s,
                          p - kEccentricity2 * kSemiMajorAxis * c * c * c);
  }
  const double s = std::sin(latitude);
  const double height =
      p * std::cos(latitude) + p_e.z() * s - kSemiMajorAxis * std::sqrt(1 - kEccentricity2 * s * s);
  return {latitude, so3::wrap(std::atan2(p_e.y(), p_e.x())), height};
}

Eigen::Matrix3d R_e_n(double latitude, double longitude) {
  const double s_lat = std::sin(latitude);
  const double c_lat = std::cos(latitude);
  const double s_lon = std::sin(longitude);
  const double c_lon = std::cos(longitude);
  Eigen::Matrix3d R;
  R << -s_lat * c_lon, -s_lon, -c_lat * c_lon,  //
      -s_lat * s_lon, c_lon, -c_lat * s_lon,    //
      c_lat, 0, -s_lat;
  return R;
}

double normal_gravity(double latitude, double height) {
  const double s2 = std::sin(latitude) * std::sin(latitude);
  const double h = height / kSemiMajorAxis;
  return gravity_on_ellipsoid(s2) * (1 - height_factor(s2) * h + 3 * h * h);
}

GravitySlope normal_gravity_slope(double latitude, double height) {
  const double s2 = std::sin(latitude) * std::sin(latitude);
  const double h = height / kSemiMajorAxis;
  const double on_ellipsoid = gravity_on_ellipsoid(s2);
  // Logarithmic derivative of Somigliana's formula by s2, and that of the height's polynomial.
  const double on_ellipsoid_by_s2 =
      on_ellipsoid *
      (kSomigliana / (1 + kSomigliana * s2) + 0.5 * kEccentricity2 / (1 - kEccentricity2 * s2));
  const double by_s2 = on_ellipsoid_by_s2 * (1 - height_factor(s2) * h + 3 * h * h) +
                       on_ellipsoid * 4 * kFlattening * h;
  return {by_s2 * std::sin(2 * latitude),
          on_ellipsoid * (6 * h - height_factor(s2)) / kSemiMajorAxis};
}

Eigen::Vector3d earth_rate_n(double latitude) {
  return {kEarthRate * std::cos(latitude), 0, -kEarthRate * std::sin(latitude)};
}

}  // namespace foucault::geodesy::wgs84
