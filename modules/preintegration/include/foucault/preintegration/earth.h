#pragma once

#include <Eigen/Core>

#include "foucault/geodesy/local_frame.h"

namespace foucault::preintegration {

/// What the preintegration models differ in; the integration itself is the same code.
enum class PreintegrationModel {
  refined,  ///< paper section III (M1): Earth rate, gravity of the origin
  rough,    ///< M2: as refined with the Earth's rate zero: no Earth rotation, no Coriolis
  full      ///< refined with the gravity vector of each interval's own place, and biases that decay
};

/// The Earth as an interval sees it, in w. Gravity at p is g_w + G (p - p_ref); with G zero it is
/// the constant vector of (9). That vector is off by 0.157 mrad per km from the origin, seen from
/// an estimator as a false rate v / R.
struct EarthModel {
  Eigen::Vector3d omega_ie_w = Eigen::Vector3d::Zero();        ///< [rad/s]; (10)
  Eigen::Vector3d g_w = Eigen::Vector3d::Zero();               ///< [m/s^2]; (9)
  Eigen::Matrix3d gravity_gradient = Eigen::Matrix3d::Zero();  ///< G [1/s^2]
  Eigen::Vector3d p_ref = Eigen::Vector3d::Zero();             ///< [m]

  Eigen::Vector3d gravity(const Eigen::Vector3d& p_w) const {
    return g_w + gravity_gradient * (p_w - p_ref);
  }
};

/// For an interval that begins at p_w. In `full`, gravity and its gradient are those of p_w.
EarthModel earth_model(PreintegrationModel model, const geodesy::LocalFrame& frame,
                       const Eigen::Vector3d& p_w);

}  // namespace foucault::preintegration
