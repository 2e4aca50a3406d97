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
/// A fix tells where the antenna is, p + C l. After a correction of C the covariance of p and l is
/// still that of the old C, so a lever arm that turns hardly show comes out surer than it is: on a
/// car with RTK the arm downward by 0.1 m, 4 sigmas. Errors of the antenna's place in place of
/// those of p would cure that (0.05 m there, drift the same within 0.5 %), and lose aerobatics
/// whose heading is hardly known at the start, which the false doubt brings round. `batch` has
/// neither.
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
