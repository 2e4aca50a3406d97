#include "foucault/measurement/nonholonomic.h"

#include "vehicle_point.h"

namespace foucault::measurement {

Nonholonomic::Nonholonomic(const BodyStretch& stretch, const Eigen::Quaterniond& q_v_b,
                           const Eigen::Vector2d& sigma)
    : stretch_(stretch), C_v_b_(q_v_b.toRotationMatrix()), sigma_(sigma) {}

state::Linearized Nonholonomic::linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                                          const state::Layout& layout) const {
  const VehiclePoint point = vehicle_point(stretch_, C_v_b_, x, layout);
  state::Linearized z(2, layout.size());
  z.r = -point.velocity_v.tail<2>();
  z.H = point.H.bottomRows<2>();
  if (const state::SlowBlock* compliance = layout.find(state::block::cornering_compliance)) {
    const double k = x.slow[compliance->index];
    const double forward = point.velocity_v.x(), rate = point.turn_rate;
    z.r[0] -= k * forward * forward * rate;
    z.H.row(0) += 2 * k * forward * rate * point.H.row(0) +
                  k * forward * forward * point.turn_rate_gradient.transpose();
    state::columns_of(z.H, *compliance)(0, 0) = forward * forward * rate;
  }
  z.R = sigma_.cwiseAbs2().asDiagonal();
  return z;
}

}  // namespace foucault::measurement
