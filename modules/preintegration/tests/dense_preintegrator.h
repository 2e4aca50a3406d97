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
  DensePreintegrator(const imu::ImuNoise& noise, const state::ImuBias& bias,
                     const ImuIncrement& before)
      : noise_(noise), before_(compensated(before, bias)) {
    m_.t_begin_ns = m_.t_end_ns = before.t_end_ns;
    m_.bias = bias;
  }

  void add(const ImuIncrement& increment) {
    const ImuIncrement inc = compensated(increment, m_.bias);
    const double dt = inc.dt();
    const Eigen::Matrix3d C = m_.dq.toRotationMatrix();
    const Eigen::Vector3d y =
        C * imu::velocity_with_sculling(before_.dtheta_b, before_.dvel_b, inc.dtheta_b, inc.dvel_b);
    m_.dq =
        (m_.dq * so3::exp(imu::rotation_with_coning(before_.dtheta_b, inc.dtheta_b))).normalized();
    propagate_errors(C, m_.dq.toRotationMatrix(), y, dt);
    m_.iidp += dt * (m_.idp + dt * (m_.dp / 2 + dt * (m_.dv / 6 + y / 24)));
    m_.idp += dt * (m_.dp + dt * (m_.dv / 2 + y / 6));
    m_.dp += dt * (m_.dv + y / 2);
    m_.dv += y;
    m_.t_end_ns = inc.t_end_ns;
    m_.dt += dt;
    before_ = inc;
  }

  preintegration::Preintegration result() const {
    using namespace state::block;
    preintegration::Preintegration out = m_;
    out.by_gyro_bias.dp = state::part(jacobian_, position, gyro_bias);
    out.by_accel_bias.dp = state::part(jacobian_, position, accel_bias);
    out.by_gyro_bias.dv = state::part(jacobian_, velocity, gyro_bias);
    out.by_accel_bias.dv = state::part(jacobian_, velocity, accel_bias);
    out.by_gyro_bias.dq = state::part(jacobian_, attitude, gyro_bias);
    return out;
  }

 private:
  static ImuIncrement compensated(const ImuIncrement& increment, const state::ImuBias& bias) {
    ImuIncrement out = increment;
    out.dtheta_b -= bias.gyro * increment.dt();
    out.dvel_b -= bias.accel * increment.dt();
    return out;
  }

  /// Biases are constant in the Jacobians and decay in the covariance.
  void propagate_errors(const Eigen::Matrix3d& C, const Eigen::Matrix3d& C_next,
                        const Eigen::Vector3d& y, double dt) {
    using namespace state::block;
    state::NodeMatrix phi = transition(C, C_next, y, dt);
    jacobian_ = phi * jacobian_;
    state::part(phi, gyro_bias, gyro_bias) *= std::exp(-dt / imu::gyro_markov_bias(noise_).tau);
    state::part(phi, accel_bias, accel_bias) *= std::exp(-dt / imu::accel_markov_bias(noise_).tau);
    const state::NodeMatrix half = 0.5 * dt * state::NodeMatrix(noise_powers().asDiagonal());
    m_.covariance = phi * (m_.covariance + half) * phi.transpose() + half;
  }

  static state::NodeMatrix transition(const Eigen::Matrix3d& C, const Eigen::Matrix3d& C_next,
                                      const Eigen::Vector3d& y, double dt) {
    using namespace state::block;
    const Eigen::Matrix3d D = 0.5 * dt * (C + C_next);
    const Eigen::Matrix3d Y = so3::skew(y);
    Eigen::Matrix<double, 3, state::kNodeSize> w =
        Eigen::Matrix<double, 3, state::kNodeSize>::Zero();
    state::columns_of(w, attitude) = -Y * C;
    state::columns_of(w, gyro_bias) = 0.5 * dt * Y * C;
    state::columns_of(w, accel_bias) = -D;
    state::NodeMatrix phi = state::NodeMatrix::Identity();
    state::part(phi, attitude, attitude) = C_next.transpose() * C;
    state::part(phi, attitude, gyro_bias) = -C_next.transpose() * D;
    state::rows_of(phi, velocity) += w;
    state::part(phi, position, velocity) = dt * Eigen::Matrix3d::Identity();
    state::rows_of(phi, position) += 0.5 * dt * w;
    return phi;
  }

  state::NodeVector noise_powers() const {
    using namespace state::block;
    state::NodeVector W = state::NodeVector::Zero();
    state::part(W, velocity).setConstant(std::pow(noise_.accel_noise_density, 2));
    state::part(W, attitude).setConstant(std::pow(noise_.gyro_noise_density, 2));
    state::part(W, gyro_bias).setConstant(noise_.gyro_bias_power());
    state::part(W, accel_bias).setConstant(noise_.accel_bias_power());
    return W;
  }

  imu::ImuNoise noise_;
  ImuIncrement before_;
  preintegration::Preintegration m_;
  state::NodeMatrix jacobian_ = state::NodeMatrix::Identity();
};

}  // namespace foucault::testing
