#include "foucault/laboratory/ablated_integrator.h"

#include "foucault/core/so3.h"

namespace foucault::laboratory {

using Eigen::Vector3d;

AblatedIntegrator::AblatedIntegrator(const state::NodeState& x0, const geodesy::LocalFrame& frame,
                                     const MotionTerms& terms, const ImuIncrement& previous)
    : frame_(frame),
      terms_(terms),
      earth_(
          preintegration::earth_model(preintegration::PreintegrationModel::full, frame, x0.p_w_b)),
      turning_(terms.earth_rotation ? earth_.omega_ie_w : Vector3d::Zero()),
      coriolis_(terms.coriolis ? earth_.omega_ie_w : Vector3d::Zero()),
      start_(x0),
      v_(x0.v_w_b),
      q_(x0.q_w_b),
      previous_(previous) {
  if (terms.gravity == GravityAlong::start) earth_.gravity_gradient.setZero();
}

Vector3d AblatedIntegrator::rotation(const ImuIncrement& increment) const {
  if (!terms_.coning) return increment.dtheta_b;
  return increment.dtheta_b + previous_.dtheta_b.cross(increment.dtheta_b) / 12;
}

Vector3d AblatedIntegrator::velocity(const ImuIncrement& increment) const {
  const Vector3d& theta = increment.dtheta_b;
  const Vector3d& dv = increment.dvel_b;
  Vector3d sum = dv;
  if (terms_.rotation) sum += theta.cross(dv) / 2;
  if (terms_.rotation_again) sum += theta.cross(theta.cross(dv)) / 6;
  if (terms_.sculling) {
    sum += (previous_.dtheta_b.cross(dv) + previous_.dvel_b.cross(theta)) / 12;
  }
  return sum;
}

Vector3d AblatedIntegrator::gravity() const {
  if (terms_.gravity == GravityAlong::place) return frame_.gravity_w(start_.p_w_b + way_);
  return earth_.g_w + earth_.gravity_gradient * way_;
}

void AblatedIntegrator::add(const ImuIncrement& increment) {
  const double dt = increment.dt();
  const Eigen::Matrix3d& G = earth_.gravity_gradient;
  const Vector3d force = q_ * velocity(increment) / dt;
  const Vector3d a = force + gravity() - 2 * coriolis_.cross(v_);
  const Vector3d a_dot = -turning_.cross(force) + G * v_ - 2 * coriolis_.cross(a);
  const Vector3d a_ddot =
      turning_.cross(turning_.cross(force)) + G * a - 2 * coriolis_.cross(a_dot);

  way_ += dt * (v_ + dt / 2 * (a + dt / 3 * (a_dot + dt / 4 * a_ddot)));
  v_ += dt * (a + dt / 2 * (a_dot + dt / 3 * a_ddot));
  q_ = (so3::exp(-turning_ * dt) * q_ * so3::exp(rotation(increment))).normalized();
  previous_ = increment;
}

state::NodeState AblatedIntegrator::state() const {
  state::NodeState x;
  x.p_w_b = start_.p_w_b + way_;
  x.v_w_b = v_;
  x.q_w_b = q_;
  return x;
}

}  // namespace foucault::laboratory
