#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "foucault/diagnosis/first_values.h"

namespace foucault::diagnosis {

/// Allan deviation of both sensors over one time, from means over whole seconds, by the median of
/// differences, which a bump does not move.
class AllanWatch {
 public:
  using Vector6d = Eigen::Matrix<double, 6, 1>;  ///< gyroscopes, accelerometers

  explicit AllanWatch(int seconds) : seconds_(seconds) {}

  void add(const Vector6d& mean);
  /// What comes next does not follow on what came before.
  void interrupt();

  /// Enough differences for a median.
  bool knows() const { return steps_[0].size() >= 5; }
  /// Density of white noise, each axis [unit of the mean / sqrt(Hz)].
  Vector6d density() const;

 private:
  int seconds_;
  Vector6d sum_ = Vector6d::Zero();
  int filled_ = 0;
  std::optional<Vector6d> before_;
  std::array<FirstValues, 6> steps_;
};

}  // namespace foucault::diagnosis
