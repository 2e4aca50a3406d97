#pragma once

#include <Eigen/Core>

/// Course over ground and its sigma. Vectors are north, east, down, or of any level frame.
namespace foucault::geodesy {

/// Azimuth [rad] of a vector's horizontal part.
double azimuth(const Eigen::Vector3d& vector);

/// Largest horizontal sigma [m] at which positions give better courses than velocities do.
constexpr double kPreciseSigma = 0.3;
/// Larger of the sigmas along north and east.
double horizontal_sigma(const Eigen::Matrix3d& covariance);

/// Sigma [rad] of the azimuth of a way or velocity with this covariance.
double course_sigma(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& way);

}  // namespace foucault::geodesy
