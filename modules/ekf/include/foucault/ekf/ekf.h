#pragma once

#include "foucault/core/config.h"
#include "foucault/ekf/error_model.h"
#include "foucault/inertial/imu_noise.h"
#include "foucault/inertial/navigator.h"

namespace foucault {

/// Section `ekf` of the configuration.
class EkfOptions : public Configurable {
 public:
  bool scale_factors = false;          ///< estimate them: 21 states instead of 15
  double gyro_scale_sigma_ppm = 1000;  ///< at the start and in the steady state
  double accel_scale_sigma_ppm = 1000;
  double scale_tau_s = 3600;
  bool use_velocity = false;    ///< of the fixes that have one
  double cov_interval_s = 0.1;  ///< longest step of the covariance

  void fields(ConfigFields& f) override;

  /// The process noise of an IMU with these scale factors.
  ekf::ProcessNoise process_noise(const ImuNoise& imu) const;
};

/// Error-state extended Kalman filter on the full NED mechanization; the paper's M0.
/// The state moves with every increment; the covariance follows in steps of several increments,
/// whenever it is asked for and at least every cov_interval_s.
/// The biases' nominal values stay as they are between updates (their turn-on values do not decay);
/// their errors are the Gauss-Markov processes of MarkovBias.
class EkfNavigator : public Navigator {
 public:
  EkfNavigator(const ImuNoise& imu, const EkfOptions& options);

  /// A new motion; scale factors that were learned before it are kept, uncorrelated with it.
  void start(const Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  Innovation innovation(const GnssFix& fix) const override;
  void update(const GnssFix& fix) override;
  void loosen(const Matrix15d& added) override;
  std::unique_ptr<Navigator> ahead(double scale) const override;
  void hold() override {}
  Epoch epoch() const override;

  const ekf::FullState& state() const { return state_; }
  /// 15 or 21 rows, at the current time.
  ekf::Matrix covariance() const;

 protected:
  /// Brings the covariance to the current time.
  void catch_up();
  /// Told of every step of the covariance.
  virtual void stepped(const ekf::Matrix& /*phi*/) {}

 private:
  /// A linearized measurement of three components: residual = H error + noise.
  struct Observation {
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, ekf::kSizeWithScale> H;
    Eigen::Vector3d residual;
    Eigen::Matrix3d noise;
  };

  using ScaleCovariance = Eigen::Matrix<double, 6, 6>;

  ScaleCovariance scale_covariance_at(int64_t t_ns) const;
  ekf::Transition pending() const;
  Observation position_observation(const GnssFix& fix) const;
  Observation velocity_observation(const GnssFix& fix) const;
  void apply(const Observation& observation);
  void inject(const ekf::Vector& error);

  ekf::ProcessNoise noise_;
  bool use_velocity_;
  double cov_interval_;

  ekf::FullState state_;
  ImuIncrement previous_;  ///< compensated; of no length after a start
  Eigen::Matrix3d R_n_b_ = Eigen::Matrix3d::Identity();

  ekf::Matrix covariance_;  ///< at covered_.t_ns
  StrapdownState covered_;
  ekf::MotionIntegrals integrals_;  ///< since then
};

}  // namespace foucault
