#include "foucault/state/nav_state.h"

#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"

namespace foucault::state {
namespace {

/// What both states have beside their place and velocity.
template <class Error>
void correct(const Error& error, Eigen::Quaterniond& q, ImuBias& bias) {
  q = (q * so3::exp(part(error, block::attitude))).normalized();
  bias.gyro += part(error, block::gyro_bias);
  bias.accel += part(error, block::accel_bias);
}

template <class Error>
void difference(const Eigen::Quaterniond& q_y, const ImuBias& bias_y, const Eigen::Quaterniond& q_x,
                const ImuBias& bias_x, Error& error) {
  part(error, block::attitude) = so3::log(q_x.conjugate() * q_y);
  part(error, block::gyro_bias) = bias_y.gyro - bias_x.gyro;
  part(error, block::accel_bias) = bias_y.accel - bias_x.accel;
}

}  // namespace

NavState boxplus(const NavState& x, const StateVector& error) {
  NavState y = x;
  y.position =
      geodesy::displaced(x.position, part(error, block::position), geodesy::Place(x.position));
  y.velocity_n += part(error, block::velocity);
  correct(error, y.q_n_b, y.bias);
  if (slow_part(error).size() > 0) y.slow += slow_part(error);
  return y;
}

StateVector boxminus(const NavState& y, const NavState& x) {
  StateVector error(state_size(x.slow.size()));
  part(error, block::position) =
      geodesy::displacement_n(x.position, y.position, geodesy::Place(x.position));
  part(error, block::velocity) = y.velocity_n - x.velocity_n;
  difference(y.q_n_b, y.bias, x.q_n_b, x.bias, error);
  slow_part(error) = y.slow - x.slow;
  return error;
}

NodeState boxplus(const NodeState& x, const NodeVector& error) {
  NodeState y = x;
  y.p_w_b += part(error, block::position);
  y.v_w_b += part(error, block::velocity);
  correct(error, y.q_w_b, y.bias);
  return y;
}

NodeVector boxminus(const NodeState& y, const NodeState& x) {
  NodeVector error;
  part(error, block::position) = y.p_w_b - x.p_w_b;
  part(error, block::velocity) = y.v_w_b - x.v_w_b;
  difference(y.q_w_b, y.bias, x.q_w_b, x.bias, error);
  return error;
}

}  // namespace foucault::state
