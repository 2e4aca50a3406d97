#include "foucault/measurement/heading.h"

#include <cmath>

#include "antenna.h"
#include "foucault/core/so3.h"

namespace foucault::measurement {

Heading::Heading(const GnssFix& fix, const Eigen::Quaterniond& q_v_b)
    : heading_(*fix.heading),
      C_b_v_(q_v_b.toRotationMatrix().transpose()),
      since_first_(fix.since_first_s) {}

state::Linearized Heading::linearize(const state::NavState& x, const MeanMotion& mean,
                                     const state::Layout& layout) const {
  constexpr double kSteep = 0.34, kTellsNothing = 1e3;  // [rad]
  const state::SlowBlock* block = layout.find(state::block::baseline_heading);
  const double direction = heading_.baseline + (block ? x.slow[block->index] : 0);
  const Eigen::Vector3d along_v(std::cos(direction), std::sin(direction), 0);
  const Eigen::Vector3d across_v(-along_v.y(), along_v.x(), 0);
  const Antenna at(x, mean, layout, Eigen::Vector3d::Zero(), since_first_);
  const Eigen::Vector3d turn = -at.offset * at.omega_b;
  const Eigen::Matrix3d back = so3::exp(turn).toRotationMatrix();
  const Eigen::Vector3d u_b = C_b_v_ * along_v;
  const Eigen::Vector3d u_n = at.C * back * u_b;

  state::Linearized by_u(3, layout.size());
  state::columns_of(by_u.H, state::block::attitude) = -at.C * so3::skew(back * u_b);
  if (block) state::columns_of(by_u.H, *block) = at.C * back * C_b_v_ * across_v;
  if (at.has_time()) {
    at.put_time(-at.C * at.omega_b.cross(back * u_b), by_u);
    const Eigen::Matrix3d by_rate =
        at.offset * at.C * back * so3::skew(u_b) * so3::right_jacobian(turn);
    at.add_rate(by_rate, by_u);
  }
  const double level_squared = u_n.head<2>().squaredNorm();
  const Eigen::RowVector3d gradient =
      Eigen::RowVector3d(-u_n.y(), u_n.x(), 0) / std::max(level_squared, kSteep * kSteep);
  state::Linearized z(1, layout.size());
  z.r[0] = so3::wrap(heading_.azimuth - std::atan2(u_n.y(), u_n.x()));
  z.H = gradient * by_u.H;
  z.R(0, 0) = level_squared > kSteep * kSteep ? heading_.sigma * heading_.sigma
                                              : kTellsNothing * kTellsNothing;
  return z;
}

}  // namespace foucault::measurement
