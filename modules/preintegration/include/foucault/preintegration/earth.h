#pragma once

#include <Eigen/Core>

#include "foucault/geodesy/local_frame.h"

namespace foucault {

/// What the preintegration models differ in; the integration itself is the same code.
enum class PreintegrationModel {
  refined,  ///< paper section III (M1): Earth rate, gravity of the origin
  rough     ///< M2: as refined with the Earth's rate zero: no Earth rotation, no Coriolis
};

/// The Earth as an interval sees it, in w.
struct EarthModel {
  Eigen::Vector3d omega_ie_w = Eigen::Vector3d::Zero();  ///< [rad/s]; (10)
  Eigen::Vector3d g_w = Eigen::Vector3d::Zero();         ///< [m/s^2]; (9)
};

EarthModel earth_model(PreintegrationModel model, const LocalFrame& frame);

}  // namespace foucault
