#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/imu/increments.h"
#include "foucault/preintegration/preintegrator.h"

namespace foucault::testing {

/// The paper's (35)-(44) with plain products of whole matrices, in the attitude error of b(t),
/// discretized as the exact derivative of one step: what the structured form must equal, and be
/// faster than.
class DensePreintegrator {
 public:
  DensePreintegrator(const ImuNoise& noise, const ImuBias& bias, const ImuIncrement& before)
      : noise_(noise), before_(compensated(before, bias)) {
    m_.t_begin_ns = m_.t_end_ns = before.t_end_ns;
    m_.bias = bias;
  }

  void add(const ImuIncrement& increment) {
    const ImuIncrement inc = compensated(increment, m_.bias);
    const double dt = inc.dt();
    const Eigen::Matrix3d C = m_.dq.toRotationMatrix();
    const Eigen::Vector3d y =
        C * velocity_with_sculling(before_.dtheta_b, before_.dvel_b, inc.dtheta_b, inc.dvel_b);
    m_.dq = (m_.dq * so3::exp(rotation_with_coning(before_.dtheta_b, inc.dtheta_b))).normalized();
    propagate_errors(C, m_.dq.toRotationMatrix(), y, dt);
    m_.iidp += dt * (m_.idp + dt * (m_.dp / 2 + dt * (m_.dv / 6 + y / 24)));
    m_.idp += dt * (m_.dp + dt * (m_.dv / 2 + y / 6));
    m_.dp += dt * (m_.dv + y / 2);
    m_.dv += y;
    m_.t_end_ns = inc.t_end_ns;
    m_.dt += dt;
    before_ = inc;
  }

  Preintegration result() const {
    using namespace block;
    Preintegration out = m_;
    out.by_gyro_bias.dp = part(jacobian_, position, gyro_bias);
    out.by_accel_bias.dp = part(jacobian_, position, accel_bias);
    out.by_gyro_bias.dv = part(jacobian_, velocity, gyro_bias);
    out.by_accel_bias.dv = part(jacobian_, velocity, accel_bias);
    out.by_gyro_bias.dq = part(jacobian_, attitude, gyro_bias);
    return out;
  }

 private:
  static ImuIncrement compensated(const ImuIncrement& increment, const ImuBias& bias) {
    ImuIncrement out = increment;
    out.dtheta_b -= bias.gyro * increment.dt();
    out.dvel_b -= bias.accel * increment.dt();
    return out;
  }

  /// Biases are constant in the Jacobians and decay in the covariance.
  void propagate_errors(const Eigen::Matrix3d& C, const Eigen::Matrix3d& C_next,
                        const Eigen::Vector3d& y, double dt) {
    using namespace block;
    NodeMatrix phi = transition(C, C_next, y, dt);
    jacobian_ = phi * jacobian_;
    part(phi, gyro_bias, gyro_bias) *= std::exp(-dt / gyro_markov_bias(noise_).tau);
    part(phi, accel_bias, accel_bias) *= std::exp(-dt / accel_markov_bias(noise_).tau);
    const NodeMatrix half = 0.5 * dt * NodeMatrix(noise_powers().asDiagonal());
    m_.covariance = phi * (m_.covariance + half) * phi.transpose() + half;
  }

  static NodeMatrix transition(const Eigen::Matrix3d& C, const Eigen::Matrix3d& C_next,
                               const Eigen::Vector3d& y, double dt) {
    using namespace block;
    const Eigen::Matrix3d D = 0.5 * dt * (C + C_next);
    const Eigen::Matrix3d Y = so3::skew(y);
    Eigen::Matrix<double, 3, kNodeSize> w = Eigen::Matrix<double, 3, kNodeSize>::Zero();
    columns_of(w, attitude) = -Y * C;
    columns_of(w, gyro_bias) = 0.5 * dt * Y * C;
    columns_of(w, accel_bias) = -D;
    NodeMatrix phi = NodeMatrix::Identity();
    part(phi, attitude, attitude) = C_next.transpose() * C;
    part(phi, attitude, gyro_bias) = -C_next.transpose() * D;
    rows_of(phi, velocity) += w;
    part(phi, position, velocity) = dt * Eigen::Matrix3d::Identity();
    rows_of(phi, position) += 0.5 * dt * w;
    return phi;
  }

  NodeVector noise_powers() const {
    using namespace block;
    NodeVector W = NodeVector::Zero();
    part(W, velocity).setConstant(std::pow(noise_.accel_noise_density, 2));
    part(W, attitude).setConstant(std::pow(noise_.gyro_noise_density, 2));
    part(W, gyro_bias).setConstant(noise_.gyro_bias_power());
    part(W, accel_bias).setConstant(noise_.accel_bias_power());
    return W;
  }

  ImuNoise noise_;
  ImuIncrement before_;
  Preintegration m_;
  NodeMatrix jacobian_ = NodeMatrix::Identity();
};

}  // namespace foucault::testing
