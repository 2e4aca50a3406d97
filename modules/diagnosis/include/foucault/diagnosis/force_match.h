#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/diagnosis/turn_match.h"

namespace foucault::diagnosis {

/// Measures the factor of the accelerometers: the length of the specific force against that of the
/// acceleration of the antenna minus gravity, over windows of three fixes a, m, b. The second
/// difference of positions and that of the specific force, turned by the gyroscopes into the axes
/// at a, added up twice and with the lever arm, are the same weighted mean of the acceleration; its
/// length needs no attitude. Windows in which the fixes accelerate a lot are left out, where one of
/// them may be wrong, and those in which the body turns a lot: gyroscopes of a wrong scale must not
/// be taken for accelerometers of one. The factor is
/// the median over the windows.
class ForceMatch {
 public:
  void add(const ImuIncrement& increment);
  void add(const GnssFix& fix);

  /// None before ten windows.
  std::optional<MeasuredFactor> factor() const;
  int64_t windows() const { return static_cast<int64_t>(ratios_.size()); }

 private:
  /// Motion since fix a in the axes of b there, without gravity and initial velocity.
  struct Motion {
    Eigen::Quaterniond q_a_b = Eigen::Quaterniond::Identity();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double turned = 0;  ///< sum of all rotations [rad]
    void add(const ImuIncrement& increment);
  };
  struct Point {
    GnssFix fix;
    Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< by the IMU, as in Motion
  };

  void add_at(const GnssFix& fix);
  void restart(const GnssFix& fix);
  void compare(const Point& b);

  std::optional<GnssFix> due_;  ///< the IMU has not yet reached it
  std::optional<Point> a_, m_;
  Motion motion_;
  std::optional<int64_t> last_ns_;
  std::vector<double> ratios_;  ///< the last kMost
  std::size_t next_ = 0;
};

}  // namespace foucault::diagnosis
