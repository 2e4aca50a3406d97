#pragma once

#include <Eigen/Core>

#include "foucault/core/measurement.h"

namespace foucault::geodesy {

/// The world frame w: North-East-Down at an origin, fixed to the Earth, Cartesian.
/// Everything goes through ECEF, so nothing in it is flat: heights and directions far from the
/// origin come out right. Units m, rad.
class LocalFrame {
 public:
  explicit LocalFrame(const Geodetic& origin);

  const Geodetic& origin() const { return origin_; }

  Eigen::Vector3d to_local(const Geodetic& position) const;
  Geodetic to_geodetic(const Eigen::Vector3d& p_w) const;

  /// Rotation from the NED of `position` to w; identity at the origin.
  Eigen::Matrix3d R_w_n(const Geodetic& position) const;

  /// Earth rate in w [rad/s], the same everywhere. Paper (10).
  const Eigen::Vector3d& earth_rate_w() const { return earth_rate_w_; }

  /// Normal gravity at the origin [m/s^2]. Paper (9).
  Eigen::Vector3d gravity_w() const;

  /// Normal gravity vector at p_w, in w [m/s^2]: down along the ellipsoid's normal of that place,
  /// so its direction turns by 0.16 mrad per km. The plumb line's curvature, 8e-9 m/s^2 per metre
  /// of height, is left out.
  Eigen::Vector3d gravity_w(const Eigen::Vector3d& p_w) const;

  /// Its derivative by p_w [1/s^2]: g/R diag(-1, -1, 2) on a sphere, here with the ellipsoid's
  /// radii of curvature and normal gravity's change by latitude and height.
  Eigen::Matrix3d gravity_gradient_w(const Eigen::Vector3d& p_w) const;

 private:
  Geodetic origin_;
  Eigen::Vector3d origin_e_;
  Eigen::Matrix3d R_e_w_;
  Eigen::Vector3d earth_rate_w_;
};

/// `to` minus `from`: north and east along the horizon of `from`, down as the difference of
/// heights [m], so that a horizontal distance d does not show as a height of d^2 / 2R.
Eigen::Vector3d ned_offset(const Geodetic& from, const Geodetic& to);

}  // namespace foucault::geodesy
