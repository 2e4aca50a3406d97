#include "foucault/evaluation/error_track.h"

#include <utility>

namespace foucault::evaluation {
namespace {

int64_t interval_of(int64_t t_ns, int64_t interval_ns) {
  const int64_t quotient = t_ns / interval_ns;
  return t_ns % interval_ns < 0 ? quotient - 1 : quotient;
}

}  // namespace

ErrorTrack::ErrorTrack(std::size_t capacity) : capacity_(capacity) {}

void ErrorTrack::add(const state::Epoch& epoch, const Eigen::Vector3d& error_n) {
  put({epoch.t_ns, epoch.position, error_n});
  if (points_.size() > capacity_) widen();
}

void ErrorTrack::put(const TrackPoint& point) {
  const bool same_interval = !points_.empty() && interval_of(points_.back().t_ns, interval_ns_) ==
                                                     interval_of(point.t_ns, interval_ns_);
  if (!same_interval) {
    points_.push_back(point);
  } else if (!(point.horizontal() <= points_.back().horizontal())) {  // not a number is the largest
    points_.back() = point;
  }
}

void ErrorTrack::widen() {
  interval_ns_ *= 2;
  const std::vector<TrackPoint> narrow = std::exchange(points_, {});
  for (const TrackPoint& point : narrow) put(point);
}

}  // namespace foucault::evaluation
