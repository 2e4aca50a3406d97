#include "foucault/geodesy/place.h"

#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::geodesy {

Place::Place(const Geodetic& position)
    : radius_north(wgs84::meridian_radius(position.latitude) + position.height),
      radius_east(wgs84::transverse_radius(position.latitude) + position.height),
      cos_latitude(std::cos(position.latitude)),
      tan_latitude(std::tan(position.latitude)),
      gravity(wgs84::normal_gravity(position.latitude, position.height)),
      omega_ie_n(wgs84::earth_rate_n(position.latitude)) {}

Eigen::Vector3d Place::omega_en_n(const Eigen::Vector3d& v_n) const {
  const double east_rate = v_n.y() / radius_east;
  return {east_rate, -v_n.x() / radius_north, -east_rate * tan_latitude};
}

Eigen::Vector3d Place::free_acceleration_n(const Eigen::Vector3d& v_n) const {
  const Eigen::Vector3d coriolis_rate = 2 * omega_ie_n + omega_en_n(v_n);
  return Eigen::Vector3d(0, 0, gravity) - coriolis_rate.cross(v_n);
}

Geodetic displaced(const Geodetic& position, const Eigen::Vector3d& d_n, const Place& place) {
  const double d_longitude = d_n.y() / (place.radius_east * place.cos_latitude);
  return {position.latitude + d_n.x() / place.radius_north,
          so3::wrap(position.longitude + d_longitude), position.height - d_n.z()};
}

Eigen::Vector3d displacement_n(const Geodetic& from, const Geodetic& to, const Place& place) {
  const double d_longitude = so3::wrap(to.longitude - from.longitude);
  return {(to.latitude - from.latitude) * place.radius_north,
          d_longitude * place.radius_east * place.cos_latitude, from.height - to.height};
}

}  // namespace foucault::geodesy
