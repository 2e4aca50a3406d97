#include "foucault/evaluation/reference_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/hermite.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::evaluation {
namespace {

/// Infinity is allowed and stays larger than any difference of stamps.
int64_t limit_ns(double seconds) {
  constexpr double kLongest = 9e9;
  return seconds < kLongest ? nanoseconds(seconds) : std::numeric_limits<int64_t>::max();
}

Eigen::Vector3d euler_difference(const so3::Euler& a, const so3::Euler& b) {
  return {so3::wrap(a.roll - b.roll), a.pitch - b.pitch, so3::wrap(a.heading - b.heading)};
}

}  // namespace

ReferencePose interpolate(const ReferencePose& a, const ReferencePose& b, int64_t t_ns) {
  const double dt = seconds_between(a.t_ns, b.t_ns);
  const double s = seconds_between(a.t_ns, t_ns) / dt;
  const geodesy::LocalFrame at_a(a.position);
  const Eigen::Vector3d b_w = at_a.to_local(b.position);

  ReferencePose between;
  between.t_ns = t_ns;
  Eigen::Vector3d p_w = s * b_w;
  if (a.velocity_n && b.velocity_n) {
    const Eigen::Vector3d v_b_w = at_a.R_w_n(b.position) * *b.velocity_n;
    p_w = hermite(s, Eigen::Vector3d::Zero(), dt * *a.velocity_n, b_w, dt * v_b_w);
    between.velocity_n = (1 - s) * *a.velocity_n + s * *b.velocity_n;
  }
  between.position = at_a.to_geodetic(p_w);
  if (a.q_n_v && b.q_n_v) between.q_n_v = a.q_n_v->slerp(s, *b.q_n_v);
  return between;
}

state::ReferenceError reference_error(const state::Epoch& epoch, const state::Mounting& mounting,
                                      const ReferencePose& reference) {
  state::ReferenceError error;
  error.t_ns = epoch.t_ns;
  error.position_n = geodesy::ned_offset(reference.position, epoch.position);
  if (reference.velocity_n) error.velocity_n = epoch.velocity_n - *reference.velocity_n;
  if (reference.q_n_v) {
    error.euler = euler_difference(state::vehicle_attitude(epoch, mounting).euler,
                                   so3::to_euler(*reference.q_n_v));
  }
  return error;
}

ReferenceComparison::ReferenceComparison(const state::Mounting& mounting, Callback callback,
                                         const ReferenceComparisonOptions& options)
    : mounting_(mounting),
      callback_(std::move(callback)),
      max_gap_ns_(limit_ns(options.max_gap_s)),
      max_linear_gap_ns_(limit_ns(options.max_linear_gap_s)),
      keep_ns_(limit_ns(options.keep_s)) {}

void ReferenceComparison::add(const ReferencePose& reference) {
  references_.push_back(reference);
  while (reference.t_ns - references_.front().t_ns > keep_ns_) references_.pop_front();
  compare_pending();
}

void ReferenceComparison::add(const state::Epoch& epoch) {
  pending_.push_back(epoch);
  compare_pending();
}

void ReferenceComparison::compare_pending() {
  while (!pending_.empty() && compare(pending_.front())) pending_.pop_front();
}

/// Whether `epoch` is dealt with; false while its reference may still come.
bool ReferenceComparison::compare(const state::Epoch& epoch) {
  while (references_.size() > 1 && references_[1].t_ns <= epoch.t_ns) references_.pop_front();
  if (references_.empty() || references_.back().t_ns < epoch.t_ns) {
    return pending_.back().t_ns - epoch.t_ns > max_gap_ns_;
  }
  const ReferencePose& before = references_.front();
  if (before.t_ns == epoch.t_ns) {
    emit(epoch, before);
  } else if (before.t_ns < epoch.t_ns && close_enough(before, references_[1])) {
    emit(epoch, interpolate(before, references_[1], epoch.t_ns));
  }
  return true;
}

bool ReferenceComparison::close_enough(const ReferencePose& a, const ReferencePose& b) const {
  const bool cubic = a.velocity_n && b.velocity_n;
  return b.t_ns - a.t_ns <= (cubic ? max_gap_ns_ : std::min(max_gap_ns_, max_linear_gap_ns_));
}

void ReferenceComparison::emit(const state::Epoch& epoch, const ReferencePose& reference) const {
  callback_(epoch, reference_error(epoch, mounting_, reference));
}

}  // namespace foucault::evaluation
