#include "foucault/evaluation/separation.h"

#include <utility>

#include "foucault/core/time.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/state/blocks.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kLeastStep = kNanosecondsPerSecond / 20;

/// Of what the smoothed sigma leaves of the forward one; none if rounding makes it negative.
Eigen::Vector3d sigma_left(const Eigen::Vector3d& forward, const Eigen::Vector3d& smoothed) {
  return (forward.cwiseAbs2() - smoothed.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

}  // namespace

SeparationCollector::SeparationCollector(const state::Mounting& mounting, Callback callback)
    : mounting_(mounting), callback_(std::move(callback)) {}

void SeparationCollector::forward(const state::Epoch& epoch) {
  if (!kept_.empty() && epoch.t_ns - kept_.back().pose.t_ns < kLeastStep) return;
  const state::VehicleAttitude vehicle = state::vehicle_attitude(epoch, mounting_);
  kept_.push_back({{epoch.t_ns, epoch.position, epoch.velocity_n, vehicle.q_n_v},
                   epoch.sigma_of(state::block::position),
                   epoch.sigma_of(state::block::velocity),
                   vehicle.sigma});
}

void SeparationCollector::smoothed(const state::Epoch& epoch) {
  while (!kept_.empty() && kept_.front().pose.t_ns < epoch.t_ns) kept_.pop_front();
  if (kept_.empty() || kept_.front().pose.t_ns != epoch.t_ns) return;
  const Kept& forward = kept_.front();
  const state::ReferenceError difference = reference_error(epoch, mounting_, forward.pose);
  const Eigen::Vector3d euler_sigma = state::vehicle_attitude(epoch, mounting_).sigma;
  add({epoch.t_ns, difference.position_n, *difference.velocity_n, *difference.euler,
       sigma_left(forward.position_sigma, epoch.sigma_of(state::block::position)),
       sigma_left(forward.velocity_sigma, epoch.sigma_of(state::block::velocity)),
       sigma_left(forward.euler_sigma, euler_sigma)});
}

void SeparationCollector::add(const state::Separation& separation) {
  if (callback_) callback_(separation);
  if (separation.t_ns < from_ns_) return;
  ++sums_.samples;
  sums_.position_rms_n += separation.position_n.cwiseAbs2();
  sums_.velocity_rms_n += separation.velocity_n.cwiseAbs2();
  sums_.euler_rms += separation.euler.cwiseAbs2();
}

SeparationMetrics SeparationCollector::metrics() const {
  SeparationMetrics metrics = sums_;
  if (metrics.samples == 0) return metrics;
  const auto samples = static_cast<double>(metrics.samples);
  for (Eigen::Vector3d* rms :
       {&metrics.position_rms_n, &metrics.velocity_rms_n, &metrics.euler_rms}) {
    *rms = (*rms / samples).cwiseSqrt();
  }
  return metrics;
}

}  // namespace foucault::evaluation
