#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "foucault/diagnosis/rest_levels.h"
#include "foucault/diagnosis/slip_watch.h"
#include "foucault/measurement/body_stretch.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

/// What is known of a vehicle without satellites: that it stands, that its wheels do not slip
/// sideways, how fast they turn. Used at stops that are about a second apart, each over all that
/// was sensed since the one before: slip and vibration are no white noise at the rate of an IMU.
/// - At rest, if fixes hold the state and it does not move, or if the IMU shakes as it did there
/// and
///   not as in motion (diagnosis::RestLevels): zero velocity and zero rate.
/// - In motion: nonholonomic and wheel speed, once a fit to what fixes showed has found how large
///   slip is (diagnosis::SlipWatch), with that noise; of `on`, from the begin on.
/// Each is gated by the chi-square test of its own dimension. Other than that of fixes it does not
/// follow the level of recent innovations: what nobody measured is not right against the state.
/// Rest that does not agree with the rates, or with the velocity, is none.
class Aiding {
 public:
  Aiding(const NavigationRunOptions& options, state::Sink& sink);

  /// From here on.
  void start(int64_t t_ns, const state::ImuBias& bias);
  void add(const WheelSpeed& speed) { wheel_waits_.push_back(speed); }
  /// `made_up`: bridges a hole; nothing was sensed since the last stop then.
  void propagate(const ImuIncrement& increment, bool made_up);

  bool is_due(int64_t t_ns) const;
  /// Uses an observation if it passes its test, and tells the sink. Gives whether it did.
  bool use(int64_t t_ns, const measurement::ObservationPtr& observation,
           measurement::Navigator& navigator);
  /// Uses what there is. held: fixes hold the state.
  void stop(int64_t t_ns, bool held, measurement::Navigator& navigator);

  /// Why wheels are not assumed, or not any more, one line; none if they are, or nothing is known.
  std::optional<std::string> remark() const;

 private:
  struct Stretch {
    measurement::BodyStretchBuilder body, wheel;
    diagnosis::ShakeMeter shake;
    Eigen::Vector3d turned_b = Eigen::Vector3d::Zero();  ///< sum of raw dtheta
    double wheel_sum = 0;
    bool made_up = false;
  };

  void take_wheel_until(const ImuIncrement& increment);
  std::optional<double> mean_wheel() const;
  struct Rest {
    measurement::ObservationPtr velocity, rate;
  };
  std::optional<Rest> rest(const state::Epoch& now, bool held,
                           const measurement::Navigator& navigator);
  bool stands(const state::Epoch& now, bool held);
  void use_wheels(int64_t t_ns, const measurement::BodyStretch& stretch,
                  measurement::Navigator& navigator);
  std::optional<Eigen::Vector2d> slip_sigma() const;
  std::optional<double> wheel_sigma() const;

  NavigationRunOptions options_;
  state::Sink& sink_;
  bool any_ = false;
  int wheels_assumed_ = 0;  ///< stops at which they were
  int64_t begin_ns_ = 0, end_ns_ = 0;
  Stretch stretch_;
  std::deque<WheelSpeed> wheel_waits_;
  diagnosis::RestLevels levels_;
  diagnosis::SlipWatch slip_;
};

}  // namespace foucault::navigation
