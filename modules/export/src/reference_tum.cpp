#include "foucault/export/reference_tum.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "foucault/core/units.h"
#include "foucault/export/solution_tum.h"
#include "foucault/export/text_file.h"

namespace foucault::exports {
namespace {

/// Of a pose with an attitude: an IMU on the axes of the vehicle.
state::Epoch as_epoch(const ReferencePose& pose) {
  state::Epoch epoch;
  epoch.t_ns = pose.t_ns;
  epoch.position = pose.position;
  epoch.q_n_b = *pose.q_n_v;
  return epoch;
}

std::string identity_row(const ReferencePose& pose, const geodesy::LocalFrame& frame) {
  const Eigen::Vector3d p_w = frame.to_local(pose.position);
  return fmt::format("{} {:.5f} {:.5f} {:.5f} 0 0 0 1\n", units::format_stamp(pose.t_ns), p_w.y(),
                     p_w.x(), -p_w.z());
}

}  // namespace

void ReferenceTum::add(const ReferencePose& pose) {
  last_ = pose;
  if (std::exchange(keeps_next_, false)) keep_last();
}

void ReferenceTum::fix() {
  if (last_) keep_last();
  keeps_next_ = true;
}

void ReferenceTum::keep_last() {
  poses_.push_back(*last_);
  last_.reset();
}

void ReferenceTum::finish() const {
  if (!origin_ || poses_.empty()) return;
  const geodesy::LocalFrame frame(*origin_);
  TextFile file(path_);
  file.write(fmt::format(
      "# East-North-Up of the first epoch of solution.tum: latitude {:.10f} deg, longitude {:.10f} "
      "deg, ellipsoidal height {:.4f} m\n",
      origin_->latitude * units::kDegrees, origin_->longitude * units::kDegrees, origin_->height));
  const bool lacks_attitude =
      std::any_of(poses_.begin(), poses_.end(), [](const ReferencePose& p) { return !p.q_n_v; });
  if (lacks_attitude) file.write("# 0 0 0 1: the recording has no attitude there\n");
  for (const ReferencePose& pose : poses_) {
    file.write(pose.q_n_v ? tum_row(as_epoch(pose), {}, frame) : identity_row(pose, frame));
  }
  file.close();
}

}  // namespace foucault::exports
