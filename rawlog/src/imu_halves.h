#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "foucault/imu/increments.h"

namespace foucault::rawlog {

/// Joins gyroscope and accelerometer that come in records of their own: samples at the stamps of
/// the gyroscope, with the specific force between its two neighbours, straight. Halves may come out
/// of order by as much as records may.
class ImuHalves {
 public:
  void add_gyro(int64_t t_ns, const Eigen::Vector3d& gyro_b) { gyro_.emplace(t_ns, gyro_b); }
  void add_accel(int64_t t_ns, const Eigen::Vector3d& accel_b) { accel_.emplace(t_ns, accel_b); }

  /// What can be joined with stamps up to `t_ns`, in order. Rates without a force within 0.1 s
  /// before and after are lost.
  std::vector<imu::ImuSample> take(int64_t t_ns);

  /// Rates that were lost.
  int64_t alone() const { return alone_; }

 private:
  std::multimap<int64_t, Eigen::Vector3d> gyro_, accel_;
  int64_t alone_ = 0;
};

}  // namespace foucault::rawlog
