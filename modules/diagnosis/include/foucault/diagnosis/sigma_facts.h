#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace foucault::diagnosis {

/// What fixes say of their own errors.
struct SigmaFacts {
  int64_t bad = 0;                       ///< zero, negative or not finite
  double smallest_m = 0, largest_m = 0;  ///< horizontal, of the others

  /// False if it is a bad one.
  bool add(const Eigen::Matrix3d& position_covariance);
};

}  // namespace foucault::diagnosis
