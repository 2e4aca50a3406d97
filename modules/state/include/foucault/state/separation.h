#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace foucault::state {

/// Smoothed less forward at one stamp. With covariances that are right, that of the difference is
/// the forward run's less the smoothed one's.
struct Separation {
  int64_t t_ns = 0;
  Eigen::Vector3d position_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d euler = Eigen::Vector3d::Zero();       ///< roll, pitch, heading [rad], wrapped
  Eigen::Vector3d position_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_sigma = Eigen::Vector3d::Zero();
  Eigen::Vector3d euler_sigma = Eigen::Vector3d::Zero();
};

}  // namespace foucault::state
