#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

#include "foucault/core/measurement.h"

namespace foucault::alignment {

/// Means of the sensors over one second.
struct RestBlock {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Means over a rest and the variances of these means: from the scatter of the blocks or, where a
/// drift stands out of it, from the difference of the halves.
struct RestMeans {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_variance = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_variance = Eigen::Vector3d::Zero();
  double duration() const { return static_cast<double>(end_ns - begin_ns) * 1e-9; }  ///< [s]
};

/// Finds a time of rest: one-second means of both sensors are steady (vibration averages out) and
/// GNSS does not move. A short disturbance, a door or the engine starting, does not end a rest.
/// Once a rest of the required length has ended, it is kept until it is too old.
class RestDetector {
 public:
  RestDetector(double min_rest_s, double max_rest_s);

  void add(const GnssFix& fix);
  /// True when a block ended in which the vehicle rested: attitude and velocity are those of rest
  /// at the end of the increment.
  bool add(const ImuIncrement& increment);

  /// Long enough, and with fixes that confirm it.
  bool established() const;
  bool ended() const { return ended_; }
  /// Only when established; the last second is left out once it has ended.
  RestMeans means() const;
  /// The same over the last seconds only, where biases are those of the drive that follows.
  RestMeans recent_means() const;
  /// The first fix in the rest, where a start may lie.
  std::optional<GnssFix> first_fix() const;

  /// Where the rest, or what may become one, begins.
  int64_t begin_ns() const;

 private:
  std::size_t blocks_used() const;
  RestMeans means_over(std::size_t first, std::size_t last) const;
  void end_block();
  bool is_still(const RestBlock& block) const;
  bool moved(const GnssFix& fix) const;
  void begin_anew(int64_t begin_ns);
  void forget_before(int64_t earliest_ns);

  std::size_t min_blocks_;
  int64_t max_rest_ns_;
  RestBlock block_;  ///< growing; its means are sums until it ends
  std::deque<RestBlock> blocks_;
  std::deque<GnssFix> fixes_;
  int disturbed_ = 0;
  bool ended_ = false;
};

}  // namespace foucault::alignment
