#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/inertial/increments.h"
#include "foucault/preintegration/preintegrator.h"

namespace foucault::testing {

/// The paper's (35)-(44) with plain 15x15 products, in the attitude error of b(t), discretized as
/// the exact derivative of one step: what the structured form must equal, and be faster than.
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
    using namespace error_state;
    Preintegration out = m_;
    out.J_dp_bg = jacobian_.block<3, 3>(kPosition, kGyroBias);
    out.J_dp_ba = jacobian_.block<3, 3>(kPosition, kAccelBias);
    out.J_dv_bg = jacobian_.block<3, 3>(kVelocity, kGyroBias);
    out.J_dv_ba = jacobian_.block<3, 3>(kVelocity, kAccelBias);
    out.J_dq_bg = jacobian_.block<3, 3>(kAttitude, kGyroBias);
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
    using namespace error_state;
    Matrix15d phi = transition(C, C_next, y, dt);
    jacobian_ = phi * jacobian_;
    phi.block<3, 3>(kGyroBias, kGyroBias) *= std::exp(-dt / gyro_markov_bias(noise_).tau);
    phi.block<3, 3>(kAccelBias, kAccelBias) *= std::exp(-dt / accel_markov_bias(noise_).tau);
    const Matrix15d half = 0.5 * dt * Matrix15d(noise_powers().asDiagonal());
    m_.covariance = phi * (m_.covariance + half) * phi.transpose() + half;
  }

  static Matrix15d transition(const Eigen::Matrix3d& C, const Eigen::Matrix3d& C_next,
                              const Eigen::Vector3d& y, double dt) {
    using namespace error_state;
    const Eigen::Matrix3d D = 0.5 * dt * (C + C_next);
    const Eigen::Matrix3d Y = so3::skew(y);
    Eigen::Matrix<double, 3, 15> w = Eigen::Matrix<double, 3, 15>::Zero();
    w.block<3, 3>(0, kAttitude) = -Y * C;
    w.block<3, 3>(0, kGyroBias) = 0.5 * dt * Y * C;
    w.block<3, 3>(0, kAccelBias) = -D;
    Matrix15d phi = Matrix15d::Identity();
    phi.block<3, 3>(kAttitude, kAttitude) = C_next.transpose() * C;
    phi.block<3, 3>(kAttitude, kGyroBias) = -C_next.transpose() * D;
    phi.middleRows<3>(kVelocity) += w;
    phi.block<3, 3>(kPosition, kVelocity) = dt * Eigen::Matrix3d::Identity();
    phi.middleRows<3>(kPosition) += 0.5 * dt * w;
    return phi;
  }

  Vector15d noise_powers() const {
    using namespace error_state;
    Vector15d W = Vector15d::Zero();
    W.segment<3>(kVelocity).setConstant(std::pow(noise_.accel_noise_density, 2));
    W.segment<3>(kAttitude).setConstant(std::pow(noise_.gyro_noise_density, 2));
    W.segment<3>(kGyroBias).setConstant(noise_.gyro_bias_power());
    W.segment<3>(kAccelBias).setConstant(noise_.accel_bias_power());
    return W;
  }

  ImuNoise noise_;
  ImuIncrement before_;
  Preintegration m_;
  Matrix15d jacobian_ = Matrix15d::Identity();
};

}  // namespace foucault::testing
