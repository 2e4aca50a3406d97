#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::diagnosis {

/// Changes of speed between fixes beside the specific force in v over the same time: whether
/// forward is forward.
class AccelerationMatch {
 public:
  explicit AccelerationMatch(const Eigen::Quaterniond& q_v_b) : q_v_b_(q_v_b) {}

  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// Of the change of speed with the force forward and to the right. None before there are enough
  /// changes, or while they are as small as their noise.
  std::optional<Eigen::Vector2d> correlation() const;

 private:
  void pair(double acceleration, const Eigen::Vector2d& force);

  Eigen::Quaterniond q_v_b_;
  std::optional<GnssFix> anchor_;
  std::optional<double> last_speed_;
  Eigen::Vector2d force_ = Eigen::Vector2d::Zero(), last_mean_ = Eigen::Vector2d::Zero();
  double time_ = 0;
  double n_ = 0, a_ = 0, aa_ = 0;  ///< sums over pairs: 1, acceleration a, a^2
  Eigen::Vector2d f_ = Eigen::Vector2d::Zero(), ff_ = Eigen::Vector2d::Zero(),
                  af_ = Eigen::Vector2d::Zero();  ///< force f, f^2, a f
};

}  // namespace foucault::diagnosis
