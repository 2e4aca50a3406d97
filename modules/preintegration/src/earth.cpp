#include "foucault/preintegration/earth.h"

#include "foucault/geodesy/wgs84.h"

namespace foucault {
namespace {

Eigen::Matrix3d gravity_gradient(const LocalFrame& frame, const Eigen::Vector3d& p_w, double g) {
  const Geodetic place = frame.to_geodetic(p_w);
  const double radius = wgs84::transverse_radius(place.latitude) + place.height;
  const Eigen::Matrix3d R_w_n = frame.R_w_n(place);
  return R_w_n * (g / radius * Eigen::Vector3d(-1, -1, 2)).asDiagonal() * R_w_n.transpose();
}

}  // namespace

EarthModel earth_model(PreintegrationModel model, const LocalFrame& frame,
                       const Eigen::Vector3d& p_w) {
  EarthModel earth;
  if (model != PreintegrationModel::rough) earth.omega_ie_w = frame.earth_rate_w();
  if (model != PreintegrationModel::full) {
    earth.g_w = frame.gravity_w();
    return earth;
  }
  earth.g_w = frame.gravity_w(p_w);
  earth.gravity_gradient = gravity_gradient(frame, p_w, earth.g_w.norm());
  earth.p_ref = p_w;
  return earth;
}

}  // namespace foucault
