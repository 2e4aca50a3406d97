#include "foucault/preintegration/earth.h"

namespace foucault {

EarthModel earth_model(PreintegrationModel model, const LocalFrame& frame) {
  EarthModel earth;
  earth.g_w = frame.gravity_w();
  if (model == PreintegrationModel::refined) earth.omega_ie_w = frame.earth_rate_w();
  return earth;
}

}  // namespace foucault
