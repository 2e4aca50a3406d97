#include "foucault/ekf/ekf.h"

#include "foucault/core/profile.h"

namespace foucault::ekf {

void EkfOptions::fields(ConfigFields& f) {
  f.number("cov_interval_s", cov_interval_s, {0, 1}, "longest step of the covariance");
  f.replaced("scale_factors", "calibrate.gyro_scale and calibrate.accel_scale (on | off)");
  f.replaced("gyro_scale_sigma_ppm", "calibrate.gyro_scale_sigma_ppm");
  f.replaced("accel_scale_sigma_ppm", "calibrate.accel_scale_sigma_ppm");
  f.replaced("scale_tau_s", "calibrate.scale_tau_s");
  f.replaced("use_velocity", "aids.gnss_velocity (on | off)");
}

EkfNavigator::EkfNavigator(const imu::ImuNoise& imu, const state::Layout& layout,
                           const EkfOptions& options)
    : noise_{imu, layout}, cov_interval_(options.cov_interval_s) {}

void EkfNavigator::start(const state::Epoch& initial) {
  const state::Epoch whole = state::with_slow_blocks(initial, noise_.layout);
  state_ = whole;
  covariance_ = whole.covariance;
  R_n_b_ = state_.q_n_b.toRotationMatrix();
  previous_ = {};
  integrals_ = {};
  covered_ = state_;
}

void EkfNavigator::propagate(const ImuIncrement& increment) {
  if (integrals_.dt + increment.dt() > cov_interval_) catch_up();
  rates_.add(increment);
  ImuIncrement clean = imu::without_bias(increment, state_.bias);
  if (noise_.layout.has_imu_scale())
    clean = imu::without_scale(clean, noise_.layout.imu_scale(state_.slow));
  state_ = imu::advance(state_, previous_, clean);
  const Eigen::Matrix3d R_n_b = state_.q_n_b.toRotationMatrix();
  integrals_.add(clean, R_n_b_, R_n_b, noise_.imu);
  R_n_b_ = R_n_b;
  previous_ = clean;
}

ekf::Transition EkfNavigator::pending() const {
  return ekf::transition(integrals_, covered_, state_, noise_);
}

void EkfNavigator::catch_up() {
  if (integrals_.dt == 0) return;
  const StageTimer timer(Stage::covariance);
  const ekf::Transition t = pending();
  covariance_ = ekf::propagated(covariance_, t);
  stepped({integrals_, covered_, state_, t.phi});
  covered_ = state_;
  integrals_ = {};
}

state::StateMatrix EkfNavigator::covariance() const {
  if (integrals_.dt == 0) return covariance_;
  const StageTimer timer(Stage::covariance);
  return ekf::propagated(covariance_, pending());
}

state::Epoch EkfNavigator::epoch() const { return {state_, covariance()}; }

state::Linearized EkfNavigator::linearize(const measurement::Observation& observation) const {
  return observation.linearize(state_, {rates_.gyro_b, rates_.accel_b}, noise_.layout);
}

state::Innovation EkfNavigator::innovation(const measurement::Observation& observation) const {
  return state::innovation_of(linearize(observation), covariance());
}

void EkfNavigator::update(const measurement::ObservationPtr& observation) {
  catch_up();
  const StageTimer timer(Stage::update);
  state::kalman_update(linearize(*observation), state_, covariance_);
  R_n_b_ = state_.q_n_b.toRotationMatrix();
  covered_ = state_;
}

void EkfNavigator::loosen(const state::NodeMatrix& added) {
  catch_up();
  state::node_part(covariance_) += added;
}

/// A filter, whatever this leaves beside its estimate.
std::unique_ptr<measurement::Navigator> EkfNavigator::ahead(double scale) const {
  auto copy = std::make_unique<EkfNavigator>(*this);
  copy->catch_up();
  copy->covariance_ *= scale * scale;
  return copy;
}

}  // namespace foucault::ekf
