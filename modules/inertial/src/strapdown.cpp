#include "foucault/inertial/strapdown.h"


#include "foucault/core/so3.h"
#include "foucault/inertial/increments.h"

namespace foucault {
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

StrapdownState corrected(const StrapdownState& state, const Vector9d& error) {
  using namespace error_state;
  StrapdownState out = state;
  out.position = displaced(state.position, error.segment<3>(kPosition), Place(state.position));
  out.v_n += error.segment<3>(kVelocity);
  out.q_n_b = (state.q_n_b * so3::exp(error.segment<3>(kAttitude))).normalized();
  return out;
}

Vector9d difference(const StrapdownState& from, const StrapdownState& to) {
  using namespace error_state;
  Vector9d error;
  error.segment<3>(kPosition) = displacement_n(from.position, to.position, Place(from.position));
  error.segment<3>(kVelocity) = to.v_n - from.v_n;
  error.segment<3>(kAttitude) = so3::log(from.q_n_b.conjugate() * to.q_n_b);
  return error;
}

ImuIncrement without_bias(const ImuIncrement& increment, const ImuBias& bias) {
  ImuIncrement compensated = increment;
  compensated.dtheta_b -= bias.gyro * increment.dt();
  compensated.dvel_b -= bias.accel * increment.dt();
  return compensated;
}

StrapdownState advance(const StrapdownState& state, const ImuIncrement& previous,
                       const ImuIncrement& increment) {
  const double dt = increment.dt();
  const SensedMotion sensed = sensed_motion(previous, increment);
  const Eigen::Vector3d sensed_velocity_n = state.q_n_b * sensed.velocity_b;

  const Geodetic mid_position =
      displaced(state.position, 0.5 * dt * state.v_n, Place(state.position));
  const Place mid(mid_position);
  const Eigen::Vector3d mid_v_n =
      state.v_n + 0.5 * (sensed_velocity_n + dt * mid.free_acceleration_n(state.v_n));
  const Eigen::Vector3d frame_rotation_n = (mid.omega_ie_n + mid.omega_en_n(mid_v_n)) * dt;

  StrapdownState next;
  next.t_ns = increment.t_end_ns;
  next.v_n = state.v_n + sensed_velocity_n - 0.5 * frame_rotation_n.cross(sensed_velocity_n) +
             dt * mid.free_acceleration_n(mid_v_n);
  next.position = displaced(state.position, 0.5 * dt * (state.v_n + next.v_n), mid);
  next.q_n_b =
      (so3::exp(-frame_rotation_n) * state.q_n_b * so3::exp(sensed.rotation_b)).normalized();
  return next;
}

}  // namespace foucault
