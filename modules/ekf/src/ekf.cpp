#include "foucault/ekf/ekf.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "foucault/core/profile.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"

namespace foucault {

using error_state::kAttitude;
using error_state::kGyroBias;
using error_state::kPosition;
using error_state::kVelocity;

namespace {

constexpr double kPpm = 1e-6;

ekf::Matrix symmetrized(const ekf::Matrix& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

void EkfOptions::fields(ConfigFields& f) {
  f.flag("scale_factors", scale_factors, "estimate scale factors: 21 states instead of 15");
  f.number("gyro_scale_sigma_ppm", gyro_scale_sigma_ppm, kPositive,
           "sigma of the gyroscopes' scale factors");
  f.number("accel_scale_sigma_ppm", accel_scale_sigma_ppm, kPositive,
           "sigma of the accelerometers' scale factors");
  f.number("scale_tau_s", scale_tau_s, kPositive, "correlation time of the scale factors");
  f.flag("use_velocity", use_velocity, "use the velocity of fixes that have one");
  f.number("cov_interval_s", cov_interval_s, {0, 1}, "longest step of the covariance");
}

ekf::ProcessNoise EkfOptions::process_noise(const ImuNoise& imu) const {
  return {imu, scale_factors, gyro_scale_sigma_ppm * kPpm, accel_scale_sigma_ppm * kPpm,
          scale_tau_s};
}

EkfNavigator::EkfNavigator(const ImuNoise& imu, const EkfOptions& options)
    : noise_(options.process_noise(imu)),
      use_velocity_(options.use_velocity),
      cov_interval_(options.cov_interval_s) {}

/// What is known of the scale factors outlives the motion: they are the sensors' own.
void EkfNavigator::start(const Epoch& initial) {
  const ScaleCovariance scale = scale_covariance_at(initial.t_ns);
  state_.motion = {initial.t_ns, initial.position, initial.velocity_n, initial.q_n_b};
  state_.bias = initial.bias;
  R_n_b_ = initial.q_n_b.toRotationMatrix();
  previous_ = {};
  integrals_ = {};
  covered_ = state_.motion;
  covariance_ = ekf::Matrix::Zero(noise_.size(), noise_.size());
  covariance_.topLeftCorner<error_state::kSize, error_state::kSize>() = initial.covariance;
  if (noise_.with_scale) covariance_.bottomRightCorner<6, 6>() = scale;
}

/// As the processes of the scale factors leave it; the steady state if there was no start before.
EkfNavigator::ScaleCovariance EkfNavigator::scale_covariance_at(int64_t t_ns) const {
  ScaleCovariance steady = ScaleCovariance::Zero();
  steady.diagonal().head<3>().setConstant(std::pow(noise_.gyro_scale_sigma, 2));
  steady.diagonal().tail<3>().setConstant(std::pow(noise_.accel_scale_sigma, 2));
  if (covariance_.rows() != ekf::kSizeWithScale) return steady;
  const double passed = std::max(0.0, seconds_between(covered_.t_ns, t_ns));
  const double left = std::exp(-2 * passed / noise_.scale_tau);
  return left * covariance_.bottomRightCorner<6, 6>() + (1 - left) * steady;
}

void EkfNavigator::propagate(const ImuIncrement& increment) {
  if (integrals_.dt + increment.dt() > cov_interval_) catch_up();
  const ImuIncrement clean = compensated(increment, state_);
  state_.motion = advance(state_.motion, previous_, clean);
  const Eigen::Matrix3d R_n_b = state_.motion.q_n_b.toRotationMatrix();
  integrals_.add(clean, R_n_b_, R_n_b, noise_.imu);
  R_n_b_ = R_n_b;
  previous_ = clean;
}

ekf::Transition EkfNavigator::pending() const {
  return ekf::transition(integrals_, covered_, state_.motion, noise_);
}

void EkfNavigator::catch_up() {
  if (integrals_.dt == 0) return;
  const StageTimer timer(Stage::covariance);
  const ekf::Transition t = pending();
  covariance_ = ekf::propagated(covariance_, t);
  covered_ = state_.motion;
  integrals_ = {};
  stepped(t.phi);
}

ekf::Matrix EkfNavigator::covariance() const {
  if (integrals_.dt == 0) return covariance_;
  const StageTimer timer(Stage::covariance);
  return ekf::propagated(covariance_, pending());
}

Epoch EkfNavigator::epoch() const {
  Epoch epoch;
  epoch.t_ns = state_.motion.t_ns;
  epoch.position = state_.motion.position;
  epoch.velocity_n = state_.motion.v_n;
  epoch.q_n_b = state_.motion.q_n_b;
  epoch.bias = state_.bias;
  epoch.covariance = covariance().topLeftCorner<error_state::kSize, error_state::kSize>();
  return epoch;
}

/// p_a = p + C exp(dtheta) l, hence d(p_a) = dp - C [l x] dtheta.
EkfNavigator::Observation EkfNavigator::position_observation(const GnssFix& fix) const {
  const Geodetic& position = state_.motion.position;
  const Eigen::Vector3d arm_n = R_n_b_ * fix.p_b_a;
  Observation o;
  o.H.setZero(3, noise_.size());
  o.H.middleCols<3>(kPosition).setIdentity();
  o.H.middleCols<3>(kAttitude) = -R_n_b_ * so3::skew(fix.p_b_a);
  o.residual = displacement_n(position, fix.antenna, Place(position)) - arm_n;
  o.noise = fix.position_covariance;
  return o;
}

/// v_a = v + C (omega_ib_b x l), hence d(v_a) = dv - C [(omega x l) x] dtheta + C [l x] dbg.
/// The rotation of n, 0.1 mm/s at a metre of lever arm, is left out.
EkfNavigator::Observation EkfNavigator::velocity_observation(const GnssFix& fix) const {
  const double dt = previous_.dt();
  const Eigen::Vector3d omega_b =
      dt > 0 ? Eigen::Vector3d(previous_.dtheta_b / dt) : Eigen::Vector3d::Zero();
  const Eigen::Vector3d arm_velocity_b = omega_b.cross(fix.p_b_a);
  Observation o;
  o.H.setZero(3, noise_.size());
  o.H.middleCols<3>(kVelocity).setIdentity();
  o.H.middleCols<3>(kAttitude) = -R_n_b_ * so3::skew(arm_velocity_b);
  o.H.middleCols<3>(kGyroBias) = R_n_b_ * so3::skew(fix.p_b_a);
  o.residual = *fix.velocity_n - state_.motion.v_n - R_n_b_ * arm_velocity_b;
  o.noise = fix.velocity_covariance;
  return o;
}

Innovation EkfNavigator::innovation(const GnssFix& fix) const {
  const Observation o = position_observation(fix);
  const Eigen::Matrix3d predicted = o.H * covariance() * o.H.transpose();
  return {o.residual, predicted + o.noise};
}

void EkfNavigator::update(const GnssFix& fix) {
  catch_up();
  apply(position_observation(fix));
  if (use_velocity_ && fix.velocity_n) apply(velocity_observation(fix));
}

void EkfNavigator::loosen(const Matrix15d& added) {
  catch_up();
  covariance_.topLeftCorner<error_state::kSize, error_state::kSize>() += added;
}

/// A filter, whatever this leaves beside its estimate.
std::unique_ptr<Navigator> EkfNavigator::ahead(double scale) const {
  auto copy = std::make_unique<EkfNavigator>(*this);
  copy->catch_up();
  copy->covariance_ *= scale * scale;
  return copy;
}

void EkfNavigator::apply(const Observation& o) {
  const StageTimer timer(Stage::update);
  using Gain = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, ekf::kSizeWithScale, 3>;
  const Gain PHt = covariance_ * o.H.transpose();
  const Eigen::Matrix3d S = o.H * PHt + o.noise;
  const Gain K = S.llt().solve(PHt.transpose()).transpose();
  // Joseph form: positive definite whatever the rounding of K.
  ekf::Matrix left = ekf::Matrix::Identity(noise_.size(), noise_.size());
  left.noalias() -= K * o.H;
  covariance_ = left * covariance_ * left.transpose() + K * o.noise * K.transpose();
  inject(K * o.residual);
}

/// With q_hat moved by exp(d), the error that was d + x becomes Jr(d) x.
void EkfNavigator::inject(const ekf::Vector& error) {
  const Eigen::Matrix3d reset = so3::right_jacobian(error.segment<3>(kAttitude));
  covariance_.middleRows<3>(kAttitude) = (reset * covariance_.middleRows<3>(kAttitude)).eval();
  covariance_.middleCols<3>(kAttitude) =
      (covariance_.middleCols<3>(kAttitude) * reset.transpose()).eval();
  covariance_ = symmetrized(covariance_);
  state_ = corrected(state_, error);
  R_n_b_ = state_.motion.q_n_b.toRotationMatrix();
  covered_ = state_.motion;
}

}  // namespace foucault
