#include "antenna.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::measurement {

Antenna::Antenna(const state::NavState& x, const MeanMotion& mean, const state::Layout& layout,
                 const Eigen::Vector3d& p_b_a, double since_first)
    : C(x.q_n_b.toRotationMatrix()),
      l_b(p_b_a),
      lever_arm(layout.find(state::block::lever_arm)),
      time_offset(layout.find(state::block::time_offset)),
      time_drift(layout.find(state::block::time_drift)),
      gyro_scale(layout.find(state::block::gyro_scale)),
      accel_scale(layout.find(state::block::accel_scale)),
      since_first_(since_first) {
  if (lever_arm) l_b += x.slow.segment<3>(lever_arm->index);
  if (time_offset) offset = x.slow[time_offset->index];
  if (time_drift) offset += since_first * x.slow[time_drift->index];
  const state::ImuScale scale = layout.imu_scale(x.slow);
  by_scale_ = (1 + scale.gyro.array()).inverse();
  by_accel_scale_ = (1 + scale.accel.array()).inverse();
  omega_b = (mean.rate_b - x.bias.gyro).cwiseProduct(by_scale_);
  swing_b = omega_b.cross(l_b);
  velocity_n = x.velocity_n + C * swing_b;
  if (!has_time() || mean.force_b.isZero()) return;
  force_b_ = (mean.force_b - x.bias.accel).cwiseProduct(by_accel_scale_);
  acceleration_n = C * force_b_ + Eigen::Vector3d(0, 0, geodesy::Place(x.position).gravity);
}

void Antenna::add_swing(double factor, state::Linearized& z) const {
  state::columns_of(z.H, state::block::attitude) -= factor * C * so3::skew(swing_b);
  add_rate(-factor * C * so3::skew(l_b), z);
  if (lever_arm) state::columns_of(z.H, *lever_arm) += factor * C * so3::skew(omega_b);
}

void Antenna::add_rate(const Eigen::Matrix3d& factor, state::Linearized& z) const {
  state::columns_of(z.H, state::block::gyro_bias) -= factor * by_scale_.asDiagonal();
  if (gyro_scale) {
    state::columns_of(z.H, *gyro_scale) -= factor * omega_b.cwiseProduct(by_scale_).asDiagonal();
  }
}

void Antenna::put_time(const Eigen::Vector3d& by_offset, state::Linearized& z) const {
  if (time_offset) state::columns_of(z.H, *time_offset) = by_offset;
  if (time_drift) state::columns_of(z.H, *time_drift) = since_first_ * by_offset;
}

void Antenna::add_acceleration(double factor, state::Linearized& z) const {
  if (force_b_.isZero()) return;
  state::columns_of(z.H, state::block::attitude) -= factor * C * so3::skew(force_b_);
  state::columns_of(z.H, state::block::accel_bias) -= factor * C * by_accel_scale_.asDiagonal();
  if (accel_scale) {
    state::columns_of(z.H, *accel_scale) -=
        factor * C * force_b_.cwiseProduct(by_accel_scale_).asDiagonal();
  }
}

}  // namespace foucault::measurement
