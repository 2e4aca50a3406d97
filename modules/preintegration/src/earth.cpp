#include "foucault/preintegration/earth.h"

namespace foucault::preintegration {

EarthModel earth_model(PreintegrationModel model, const geodesy::LocalFrame& frame,
                       const Eigen::Vector3d& p_w) {
  EarthModel earth;
  if (model != PreintegrationModel::rough) earth.omega_ie_w = frame.earth_rate_w();
  if (model != PreintegrationModel::full) {
    earth.g_w = frame.gravity_w();
    return earth;
  }
  earth.g_w = frame.gravity_w(p_w);
  earth.gravity_gradient = frame.gravity_gradient_w(p_w);
  earth.p_ref = p_w;
  return earth;
}

}  // namespace foucault::preintegration
