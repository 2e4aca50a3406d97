#pragma once

#include <Eigen/Core>

namespace foucault {

/// The cubic with values a, b and slopes slope_a, slope_b by s at s = 0 and s = 1.
inline Eigen::Vector3d hermite(double s, const Eigen::Vector3d& a, const Eigen::Vector3d& slope_a,
                               const Eigen::Vector3d& b, const Eigen::Vector3d& slope_b) {
  const double r = 1 - s;
  return r * r * ((1 + 2 * s) * a + s * slope_a) + s * s * ((1 + 2 * r) * b - r * slope_b);
}

}  // namespace foucault
