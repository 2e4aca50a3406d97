#include "foucault/export/solution_tum.h"

#include <fmt/format.h>

#include <cmath>

#include "foucault/core/units.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::exports {

std::string tum_row(const state::Epoch& epoch, const state::Mounting& mounting,
                    const geodesy::LocalFrame& frame) {
  const Eigen::Quaterniond q_enu_ned(0, std::sqrt(0.5), std::sqrt(0.5), 0);
  const Eigen::Quaterniond q_frd_flu(0, 1, 0, 0);
  const Eigen::Vector3d p_w = frame.to_local(epoch.position);
  const Eigen::Quaterniond q_w_n(frame.R_w_n(epoch.position));
  const Eigen::Quaterniond q =
      (q_enu_ned * q_w_n * vehicle_attitude(epoch, mounting).q_n_v * q_frd_flu).normalized();
  return fmt::format("{} {:.5f} {:.5f} {:.5f} {:.10f} {:.10f} {:.10f} {:.10f}\n",
                     units::format_stamp(epoch.t_ns), p_w.y(), p_w.x(), -p_w.z(), q.x(), q.y(),
                     q.z(), q.w());
}

SolutionTum::SolutionTum(const std::filesystem::path& path, const state::Mounting& mounting)
    : mounting_(mounting), file_(path) {}

void SolutionTum::epoch(const state::Epoch& epoch) {
  if (!frame_) frame_.emplace(epoch.position);
  file_.write(tum_row(epoch, mounting_, *frame_));
}

}  // namespace foucault::exports
