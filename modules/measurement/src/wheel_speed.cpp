#include "foucault/measurement/wheel_speed.h"

#include "vehicle_point.h"

namespace foucault::measurement {

WheelSpeedMean::WheelSpeedMean(const BodyStretch& stretch, const Eigen::Quaterniond& q_v_b,
                               double speed, double sigma)
    : stretch_(stretch), C_v_b_(q_v_b.toRotationMatrix()), speed_(speed), sigma_(sigma) {}

state::Linearized WheelSpeedMean::linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                                            const state::Layout& layout) const {
  const VehiclePoint point = vehicle_point(stretch_, C_v_b_, x, layout);
  state::Linearized z(1, layout.size());
  z.r[0] = speed_ - point.velocity_v.x();
  z.H = point.H.topRows<1>();
  if (const state::SlowBlock* scale = layout.find(state::block::wheel_scale)) {
    z.r[0] += x.slow[scale->index] * speed_;
    state::columns_of(z.H, *scale).setConstant(-speed_);
  }
  z.R(0, 0) = sigma_ * sigma_;
  return z;
}

}  // namespace foucault::measurement
