#include "foucault/geodesy/local_frame.h"

#include "foucault/geodesy/wgs84.h"

namespace foucault::geodesy {

LocalFrame::LocalFrame(const Geodetic& origin)
    : origin_(origin),
      origin_e_(wgs84::geodetic_to_ecef(origin)),
      R_e_w_(wgs84::R_e_n(origin.latitude, origin.longitude)),
      earth_rate_w_(wgs84::earth_rate_n(origin.latitude)) {}

Eigen::Vector3d LocalFrame::to_local(const Geodetic& position) const {
  return R_e_w_.transpose() * (wgs84::geodetic_to_ecef(position) - origin_e_);
}

Geodetic LocalFrame::to_geodetic(const Eigen::Vector3d& p_w) const {
  return wgs84::ecef_to_geodetic(origin_e_ + R_e_w_ * p_w);
}

Eigen::Matrix3d LocalFrame::R_w_n(const Geodetic& position) const {
  return R_e_w_.transpose() * wgs84::R_e_n(position.latitude, position.longitude);
}

Eigen::Vector3d LocalFrame::gravity_w() const {
  return {0, 0, wgs84::normal_gravity(origin_.latitude, origin_.height)};
}

Eigen::Vector3d LocalFrame::gravity_w(const Eigen::Vector3d& p_w) const {
  const Geodetic place = to_geodetic(p_w);
  return wgs84::normal_gravity(place.latitude, place.height) * R_w_n(place).col(2);
}

Eigen::Matrix3d LocalFrame::gravity_gradient_w(const Eigen::Vector3d& p_w) const {
  const Geodetic place = to_geodetic(p_w);
  const double g = wgs84::normal_gravity(place.latitude, place.height);
  const double north_radius = wgs84::meridian_radius(place.latitude) + place.height;
  const double east_radius = wgs84::transverse_radius(place.latitude) + place.height;
  const wgs84::GravitySlope slope = wgs84::normal_gravity_slope(place.latitude, place.height);
  Eigen::Matrix3d G_n = Eigen::Matrix3d::Zero();  // rows: gravity, columns: way north, east, down
  G_n.diagonal() << -g / north_radius, -g / east_radius, -slope.by_height;
  G_n(2, 0) = slope.by_latitude / north_radius;
  const Eigen::Matrix3d R = R_w_n(place);
  return R * G_n * R.transpose();
}

Eigen::Vector3d ned_offset(const Geodetic& from, const Geodetic& to) {
  const Eigen::Vector3d p_w = LocalFrame(from).to_local(to);
  return {p_w.x(), p_w.y(), from.height - to.height};
}

}  // namespace foucault::geodesy
