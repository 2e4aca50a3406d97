#include "foucault/imu/strapdown.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"
#include "foucault/imu/increments.h"

namespace foucault::imu {
namespace {

/// Motion sensed by the IMU over an increment, relative to inertial space.
struct SensedMotion {
  Eigen::Vector3d rotation_b;  ///< rotation vector of the body [rad]
  Eigen::Vector3d velocity_b;  ///< by specific force, in b at the beginning [m/s]
};

SensedMotion sensed_motion(const ImuIncrement& previous, const ImuIncrement& increment) {
  const double scale =
      previous.dt() > 0 ? previous_increment_scale(previous.dt(), increment.dt()) : 0.0;
  const Eigen::Vector3d previous_dtheta = scale * previous.dtheta_b;
  const Eigen::Vector3d previous_dvel = scale * previous.dvel_b;
  const Eigen::Vector3d& dtheta = increment.dtheta_b;
  const Eigen::Vector3d& dvel = increment.dvel_b;
  return {rotation_with_coning(previous_dtheta, dtheta),
          velocity_with_sculling(previous_dtheta, previous_dvel, dtheta, dvel)};
}

}  // namespace

ImuIncrement without_bias(const ImuIncrement& increment, const state::ImuBias& bias) {
  ImuIncrement compensated = increment;
  compensated.dtheta_b -= bias.gyro * increment.dt();
  compensated.dvel_b -= bias.accel * increment.dt();
  return compensated;
}

ImuIncrement without_scale(const ImuIncrement& increment, const state::ImuScale& scale) {
  ImuIncrement compensated = increment;
  compensated.dtheta_b = scale.gyro_gain() * increment.dtheta_b;
  compensated.dvel_b = scale.accel_gain() * increment.dvel_b;
  return compensated;
}

state::NavState advance(const state::NavState& state, const ImuIncrement& previous,
                        const ImuIncrement& increment) {
  const double dt = increment.dt();
  const SensedMotion sensed = sensed_motion(previous, increment);
  const Eigen::Vector3d sensed_velocity_n = state.q_n_b * sensed.velocity_b;

  const Geodetic mid_position = geodesy::displaced(state.position, 0.5 * dt * state.velocity_n,
                                                   geodesy::Place(state.position));
  const geodesy::Place mid(mid_position);
  const Eigen::Vector3d mid_v_n =
      state.velocity_n + 0.5 * (sensed_velocity_n + dt * mid.free_acceleration_n(state.velocity_n));
  const Eigen::Vector3d frame_rotation_n = (mid.omega_ie_n + mid.omega_en_n(mid_v_n)) * dt;

  state::NavState next = state;
  next.t_ns = increment.t_end_ns;
  next.velocity_n = state.velocity_n + sensed_velocity_n -
                    0.5 * frame_rotation_n.cross(sensed_velocity_n) +
                    dt * mid.free_acceleration_n(mid_v_n);
  next.position =
      geodesy::displaced(state.position, 0.5 * dt * (state.velocity_n + next.velocity_n), mid);
  next.q_n_b =
      (so3::exp(-frame_rotation_n) * state.q_n_b * so3::exp(sensed.rotation_b)).normalized();
  return next;
}

}  // namespace foucault::imu
