#include "aiding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "foucault/core/time.h"
#include "foucault/diagnosis/fix_judge.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/nonholonomic.h"
#include "foucault/measurement/wheel_speed.h"
#include "foucault/measurement/zero_rate.h"
#include "foucault/measurement/zero_velocity.h"

namespace foucault::navigation {
namespace {

/// Slip lasts for seconds.
constexpr double kInterval = 0.95;  // [s]: a second and the jitter of stamps
/// Before the recording has shown it, of `on`; by the mean of a second.
constexpr double kUsualSlip = 0.1;        // [m/s]
constexpr double kUsualWheelNoise = 0.1;  // [m/s]
/// White noise of as much power as the slip; above it, the aid tells nothing that an IMU would not
/// know better for a minute.
constexpr double kMostSlip = 0.5;  // [m/s]
constexpr double kMostWheelScale = 0.3;

/// Probability that a right measurement disagrees more.
double agreement(const state::Innovation& innovation) {
  return diagnosis::chi_square_tail(diagnosis::mahalanobis_squared(innovation),
                                    static_cast<int>(innovation.value.size()));
}

}  // namespace

Aiding::Aiding(const NavigationRunOptions& options, state::Sink& sink)
    : options_(options), sink_(sink), slip_(options.mounting.q_v_b) {
  const measurement::AidOptions& aids = options.aids;
  any_ =
      aids.uses(aids.zero_velocity) || aids.uses(aids.nonholonomic) || aids.uses(aids.wheel_speed);
}

void Aiding::start(int64_t t_ns, const state::ImuBias& bias) {
  begin_ns_ = end_ns_ = t_ns;
  stretch_ = {};
  stretch_.body.start(t_ns, bias);
  stretch_.wheel.start(t_ns, bias);
}

void Aiding::propagate(const ImuIncrement& increment, bool made_up) {
  if (!any_) return;
  stretch_.made_up |= made_up;
  stretch_.body.add(increment);
  stretch_.body.mark();
  stretch_.shake.add(increment);
  stretch_.turned_b += increment.dtheta_b;
  take_wheel_until(increment);
  end_ns_ = increment.t_end_ns;
}

void Aiding::take_wheel_until(const ImuIncrement& increment) {
  ImuIncrement rest = increment;
  while (!wheel_waits_.empty() && wheel_waits_.front().t_ns <= increment.t_end_ns) {
    const WheelSpeed speed = wheel_waits_.front();
    wheel_waits_.pop_front();
    if (speed.t_ns <= begin_ns_) continue;
    if (speed.t_ns > rest.t_begin_ns && speed.t_ns < rest.t_end_ns) {
      const auto [until, after] = imu::split(rest, speed.t_ns);
      stretch_.wheel.add(until);
      rest = after;
    } else if (speed.t_ns == rest.t_end_ns && rest.dt() > 0) {
      stretch_.wheel.add(rest);
      rest.t_begin_ns = rest.t_end_ns;
    }
    stretch_.wheel.mark();
    stretch_.wheel_sum += speed.forward;
  }
  if (rest.dt() > 0) stretch_.wheel.add(rest);
}

bool Aiding::is_due(int64_t t_ns) const {
  return any_ && seconds_between(begin_ns_, t_ns) > kInterval;
}

std::optional<double> Aiding::mean_wheel() const {
  const std::optional<measurement::BodyStretch> stretch = stretch_.wheel.stretch();
  if (!stretch) return std::nullopt;
  return stretch_.wheel_sum / stretch->instants;
}

void Aiding::stop(int64_t t_ns, bool held, measurement::Navigator& navigator) {
  const state::Epoch now = navigator.epoch();
  const std::optional<measurement::BodyStretch> stretch = stretch_.body.stretch();
  if (stretch && !stretch_.made_up) {
    if (held) slip_.add(*stretch, now, mean_wheel());
    if (const std::optional<Rest> known = rest(now, held, navigator)) {
      use(t_ns, known->velocity, navigator);
      use(t_ns, known->rate, navigator);
    } else {
      use_wheels(t_ns, *stretch, navigator);
    }
  }
  start(t_ns, now.bias);
}

/// Fixes that hold the state tell it to centimetres a second, and the levels are learned; else the
/// levels decide, a hundred to one.
bool Aiding::stands(const state::Epoch& now, bool held) {
  constexpr double kKnown = 0.2, kCreeps = 0.05, kMoves = 0.3;  // [m/s]
  constexpr double kCertain = 4.6;                              // log(100)
  const std::optional<diagnosis::ShakeLevel> level = stretch_.shake.level();
  if (!level) return false;
  const double odds = levels_.log_odds(*level);
  const double sigma =
      std::sqrt(now.covariance_of(state::block::velocity).topLeftCorner<2, 2>().trace());
  const double speed = now.velocity_n.norm();
  const bool still = sigma < kKnown && speed < kCreeps + 2 * sigma;
  if (held && still) levels_.learn(*level, true);
  if (held && speed > kMoves + 4 * sigma) levels_.learn(*level, false);
  return still ? odds >= 0 : odds > kCertain;
}

/// A hover, a turn on the spot or a straight at constant speed is none: one in a thousand true ones
/// is missed.
std::optional<Aiding::Rest> Aiding::rest(const state::Epoch& now, bool held,
                                         const measurement::Navigator& navigator) {
  constexpr double kMissed = 1e-3;
  if (!stands(now, held) || !options_.aids.uses(options_.aids.zero_velocity)) return std::nullopt;
  const double dt = seconds_between(begin_ns_, end_ns_);
  const double rate_sigma =
      std::max(options_.imu.gyro_noise_density / std::sqrt(dt), stretch_.shake.mean_rate_sigma());
  const Rest rest{
      std::make_shared<measurement::ZeroVelocity>(options_.aids.zero_velocity_sigma_m_s),
      std::make_shared<measurement::ZeroRate>(stretch_.turned_b / dt, rate_sigma)};
  if (agreement(navigator.innovation(*rest.velocity)) < kMissed) return std::nullopt;
  if (agreement(navigator.innovation(*rest.rate)) < kMissed) return std::nullopt;
  return rest;
}

std::optional<std::string> Aiding::remark() const {
  const std::optional<diagnosis::SlipFindings>& found = slip_.slip();
  if (options_.aids.nonholonomic != "auto" || !any_ || !found || slip_sigma()) return std::nullopt;
  const std::string what =
      wheels_assumed_ == 0 ? std::string("was not used")
                           : fmt::format("was used {} times and then given up", wheels_assumed_);
  return fmt::format(
      "that wheels do not slip {}: beside rolling forward it moves by {:.2f} m/s to the side and "
      "{:.2f} m/s up and down (1 sigma)",
      what, found->deviation[0], found->deviation[1]);
}

std::optional<Eigen::Vector2d> Aiding::slip_sigma() const {
  const measurement::AidOptions& aids = options_.aids;
  if (!aids.uses(aids.nonholonomic)) return std::nullopt;
  const std::optional<diagnosis::SlipFindings>& found = slip_.slip();
  if (aids.nonholonomic != "on" && (!found || found->white.minCoeff() > kMostSlip))
    return std::nullopt;
  if (const std::optional<double> right = aids.nonholonomic_sigma_m_s)
    return Eigen::Vector2d(*right, aids.nonholonomic_down_sigma_m_s.value_or(*right));
  if (!found) return Eigen::Vector2d::Constant(kUsualSlip);
  return found->white;
}

std::optional<double> Aiding::wheel_sigma() const {
  const measurement::AidOptions& aids = options_.aids;
  if (!aids.uses(aids.wheel_speed)) return std::nullopt;
  const std::optional<diagnosis::WheelFindings>& found = slip_.wheel();
  if (aids.wheel_speed != "on") {
    if (!found || std::abs(found->scale) > kMostWheelScale || found->white > kMostSlip)
      return std::nullopt;
  }
  if (aids.wheel_speed_sigma_m_s) return *aids.wheel_speed_sigma_m_s;
  return found ? found->white : kUsualWheelNoise;
}

void Aiding::use_wheels(int64_t t_ns, const measurement::BodyStretch& stretch,
                        measurement::Navigator& navigator) {
  if (const std::optional<Eigen::Vector2d> sigma = slip_sigma()) {
    const auto wheels =
        std::make_shared<measurement::Nonholonomic>(stretch, options_.mounting.q_v_b, *sigma);
    if (use(t_ns, wheels, navigator)) ++wheels_assumed_;
  }
  const std::optional<measurement::BodyStretch> wheel = stretch_.wheel.stretch();
  const std::optional<double> sigma = wheel_sigma();
  if (wheel && sigma) {
    use(t_ns,
        std::make_shared<measurement::WheelSpeedMean>(*wheel, options_.mounting.q_v_b,
                                                      *mean_wheel(), *sigma),
        navigator);
  }
}

bool Aiding::use(int64_t t_ns, const measurement::ObservationPtr& observation,
                 measurement::Navigator& navigator) {
  const state::Innovation innovation = navigator.innovation(*observation);
  const bool believed = agreement(innovation) >= options_.gnss.gate_false_alarm;
  if (believed) navigator.update(observation);
  sink_.observation({t_ns, observation->name(), static_cast<int>(innovation.value.size()),
                     diagnosis::mahalanobis_squared(innovation), believed});
  return believed;
}

}  // namespace foucault::navigation
