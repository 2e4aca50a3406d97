#pragma once

#include "foucault/core/config.h"
#include "foucault/ekf/error_model.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/measurement/navigator.h"

namespace foucault::ekf {

/// Section `ekf` of the configuration.
class EkfOptions : public Configurable {
 public:
  double cov_interval_s = 0.1;  ///< longest step of the covariance

  void fields(ConfigFields& f) override;
};

/// Error-state extended Kalman filter on the full NED mechanization; the paper's M0.
/// The state moves with every increment; the covariance follows in steps of several increments,
/// whenever it is asked for and at least every cov_interval_s.
/// The biases' nominal values stay as they are between updates (their turn-on values do not decay);
/// their errors are the Gauss-Markov processes of MarkovBias, those of slow blocks as the layout
/// has them.
///
/// A fix tells where the antenna is, p + C l. An update that corrects C leaves a covariance of p
/// and l that fits the old C: the next fix would find the antenna elsewhere than this one, by the
/// correction times the error of l, and tell of l as if the vehicle had turned. So, where the lever
/// arm is estimated, the covariance of p is moved along with what H(x+) has by C and l: what the
/// fix told of the antenna's place stays told. (Errors of the antenna's place, of C and of l would
/// be coordinates in which nothing has to be moved.) Not with what H has by the time offset, the
/// antenna's velocity: its correction is mostly that of the fix's own error.
class EkfNavigator : public measurement::Navigator {
 public:
  explicit EkfNavigator(const imu::ImuNoise& imu, const state::Layout& layout = {},
                        const EkfOptions& options = {});

  void start(const state::Epoch& initial) override;
  void propagate(const ImuIncrement& increment) override;
  state::Innovation innovation(const measurement::Observation& observation) const override;
  void update(const measurement::ObservationPtr& observation) override;
  void loosen(const state::NodeMatrix& added) override;
  std::unique_ptr<measurement::Navigator> ahead(double scale) const override;
  void hold() override {}
  state::Epoch epoch() const override;

  const state::NavState& state() const { return state_; }
  /// At the current time.
  state::StateMatrix covariance() const;

 protected:
  /// Brings the covariance to the current time.
  void catch_up();
  /// A step of the covariance.
  struct Step {
    const ekf::MotionIntegrals& integrals;
    const state::NavState &begin, &end;
    const ekf::Phi& phi;
  };
  /// Told of every one.
  virtual void stepped(const Step& /*step*/) {}
  state::Linearized linearize(const measurement::Observation& observation) const;

 private:
  ekf::Transition pending() const;

  ekf::ProcessNoise noise_;
  double cov_interval_;

  state::NavState state_;
  ImuIncrement previous_;  ///< compensated; of no length after a start
  imu::RecentRates rates_{imu::kLeverArmRateMemory};
  Eigen::Matrix3d R_n_b_ = Eigen::Matrix3d::Identity();

  state::StateMatrix covariance_;  ///< at covered_.t_ns
  state::NavState covered_;
  ekf::MotionIntegrals integrals_;  ///< since then
};

}  // namespace foucault::ekf
