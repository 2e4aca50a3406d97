#include "imu_halves.h"

#include <iterator>
#include <optional>

namespace foucault::rawlog {

namespace {

constexpr int64_t kFarApart = 100'000'000;  ///< [ns]

/// Of the straight line between two neighbours; none if one is missing or far away.
std::optional<Eigen::Vector3d> force_at(int64_t t_ns,
                                        const std::multimap<int64_t, Eigen::Vector3d>& forces) {
  const auto after = forces.lower_bound(t_ns);
  if (after == forces.end()) return std::nullopt;
  if (after->first == t_ns) return after->second;
  if (after == forces.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const int64_t length_ns = after->first - before->first;
  if (length_ns > kFarApart) return std::nullopt;
  const double part = static_cast<double>(t_ns - before->first) / static_cast<double>(length_ns);
  return before->second + part * (after->second - before->second);
}

}  // namespace

std::vector<imu::ImuSample> ImuHalves::take(int64_t t_ns) {
  std::vector<imu::ImuSample> samples;
  while (!gyro_.empty() && gyro_.begin()->first <= t_ns) {
    const auto [stamp_ns, gyro_b] = *gyro_.begin();
    gyro_.erase(gyro_.begin());
    const std::optional<Eigen::Vector3d> accel_b = force_at(stamp_ns, accel_);
    if (accel_b) {
      samples.push_back({stamp_ns, gyro_b, *accel_b});
    } else {
      ++alone_;
    }
  }
  while (!accel_.empty() && accel_.begin()->first < t_ns - 2 * kFarApart) {
    accel_.erase(accel_.begin());
  }
  return samples;
}

}  // namespace foucault::rawlog
