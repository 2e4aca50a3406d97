#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "foucault/state/result.h"

namespace foucault::evaluation {

/// An estimate and what it errs by, for figures.
struct TrackPoint {
  int64_t t_ns = 0;
  Geodetic position;                                  ///< estimate, of the IMU centre
  Eigen::Vector3d error_n = Eigen::Vector3d::Zero();  ///< estimate minus truth, NED [m]

  double horizontal() const { return error_n.head<2>().norm(); }
};

/// Keeps a run's errors in bounded memory: of the points in each interval the one with the largest
/// horizontal error, so that peaks stay. The interval doubles whenever there are too many.
class ErrorTrack {
 public:
  explicit ErrorTrack(std::size_t capacity = 4096);

  /// In order of stamps.
  void add(const state::Epoch& epoch, const Eigen::Vector3d& error_n);

  const std::vector<TrackPoint>& points() const { return points_; }

 private:
  void put(const TrackPoint& point);
  void widen();

  std::size_t capacity_;
  int64_t interval_ns_ = 250'000'000;
  std::vector<TrackPoint> points_;
};

}  // namespace foucault::evaluation
