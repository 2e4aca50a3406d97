#include "airliner.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::simulation {
namespace {

constexpr double kGravity = 9.81;

constexpr double kCruiseAltitude = 10000;       ///< [m]
constexpr double kCruiseSpeed = 250;            ///< [m/s]
constexpr double kClimbRate = 12;               ///< [m/s]
constexpr double kDescentRate = 10;             ///< [m/s]
constexpr double kTakeOffSpeed = 80;            ///< [m/s]
constexpr double kLandingSpeed = 72;            ///< [m/s]
constexpr double kRunwayAcceleration = 1.8;     ///< [m/s^2]
constexpr double kAirAcceleration = 0.5;        ///< [m/s^2]
constexpr double kMaxVertical = 1.0;            ///< [m/s^2]
constexpr double kLevelOff = 15;                ///< time constant of reaching a height [s]
constexpr double kRollRate = 4 * kDegree;       ///< into and out of turns [rad/s]
constexpr double kTurnAltitude = 600;           ///< no turns lower [m]
constexpr double kSlowAltitude = 4000;          ///< slower below, on the way down [m]
constexpr double kLandingReserve = 200;         ///< for the approach, the landing and the taxi [s]
constexpr double kShortestFlight = 600;         ///< a shorter one does not land [s]
constexpr double kFirstTurnAfter = 100;         ///< [s]
constexpr double kMaxDeviation = 40 * kDegree;  ///< beyond, turns lead back to the first heading

/// The highest altitude from which a flight of this length can be down in time.
double reachable_altitude(double flight_s) {
  if (flight_s < kShortestFlight) return kCruiseAltitude;
  const double vertical = flight_s - kTakeOffSpeed / kRunwayAcceleration - kLandingReserve;
  return std::min(kCruiseAltitude, 0.9 * vertical / (1 / kClimbRate + 1 / kDescentRate));
}

}  // namespace

Airliner::Airliner(const ScenarioOptions& options)
    : rest_s_(options.rest_s),
      duration_s_(options.skip_s + options.duration_s),
      start_height_(options.height_m),
      cruise_altitude_(reachable_altitude(duration_s_ - rest_s_)),
      draws_(options.seed, RandomStream::motion),
      position_(options.start_position()),
      first_heading_(start_heading(options)),
      heading_(first_heading_),
      next_turn_s_(rest_s_ + kFirstTurnAfter),
      bumps_({}),
      roll_noise_({}),
      pitch_noise_({}) {
  Draws draws(options.seed, RandomStream::surface);
  bumps_ = SineSum({{0.2, 900, draws.phase()}, {0.3, 2900, draws.phase()}});
  roll_noise_ =
      SineSum({{0.3 * kDegree, 1100, draws.phase()}, {0.3 * kDegree, 2300, draws.phase()}});
  pitch_noise_ =
      SineSum({{0.1 * kDegree, 900, draws.phase()}, {0.15 * kDegree, 3100, draws.phase()}});
}

bool Airliner::descends() const {
  const bool lands = duration_s_ - rest_s_ >= kShortestFlight;
  return lands && duration_s_ - time_ < altitude_ / kDescentRate + kLandingReserve;
}

double Airliner::wanted_speed() const {
  if (!flies()) return descends() ? 0 : kTakeOffSpeed + 5;
  return descends() && altitude_ < kSlowAltitude ? kLandingSpeed : kCruiseSpeed;
}

double Airliner::wanted_climb() const {
  const bool lifted = flies() || (!descends() && speed_ > kTakeOffSpeed);
  if (!lifted) return 0;
  const double target = descends() ? 0 : cruise_altitude_;
  return std::clamp((target - altitude_) / kLevelOff, -kDescentRate, kClimbRate);
}

void Airliner::plan_turn() {
  const double deviation = heading_ - first_heading_;
  const double side =
      std::abs(deviation) > kMaxDeviation ? (deviation > 0 ? -1.0 : 1.0) : draws_.sign();
  turn_left_ = side * draws_.uniform(10, 60) * kDegree;
  turn_bank_ = side * draws_.uniform(15, 25) * kDegree;
  next_turn_s_ = time_ + draws_.uniform(90, 300);
}

/// Heading goes on changing while the bank is taken out at kRollRate: level off when just that much
/// is left.
double Airliner::bank_for_remaining_turn() const {
  const double while_levelling =
      kGravity / std::max(speed_, 50.0) * bank_ * bank_ / (2 * kRollRate);
  const double left = turn_bank_ > 0 ? turn_left_ : -turn_left_;
  return left > while_levelling ? turn_bank_ : 0.0;
}

double Airliner::wanted_bank() {
  const bool low = altitude_ < std::min(kTurnAltitude, 0.5 * cruise_altitude_);
  if (low) return 0;
  if (time_ > next_turn_s_ && bank_ == 0) plan_turn();
  return bank_for_remaining_turn();
}

void Airliner::advance(double dt) {
  time_ += dt;
  if (time_ < rest_s_) return;
  const double limit = flies() ? kAirAcceleration : kRunwayAcceleration;
  speed_ = toward(speed_, wanted_speed(), limit * dt);
  climb_ = toward(climb_, wanted_climb(), kMaxVertical * dt);
  bank_ = toward(bank_, wanted_bank(), kRollRate * dt);
  const double turn = speed_ > 0 ? kGravity * std::tan(bank_) / speed_ * dt : 0.0;
  turn_left_ -= turn;
  const double mid_heading = heading_ + turn / 2;
  const double step = speed_ * dt;
  heading_ += turn;
  altitude_ = std::max(0.0, altitude_ + climb_ * dt);
  distance_ += step;
  move_along_earth(position_, step * std::cos(mid_heading), step * std::sin(mid_heading));
  position_.height = start_height_ + altitude_ + bumps_.at(distance_) - bumps_.at(0);
}

double Airliner::angle_of_attack() const {
  const double lift = std::min(1.0, altitude_ / 30);
  const double slow = kTakeOffSpeed / std::max(speed_, kTakeOffSpeed);
  return lift * (1.5 + 5 * slow * slow) * kDegree;
}

double Airliner::pitch() const {
  const double flight_path = speed_ > 0 ? std::atan2(climb_, speed_) : 0;
  return flight_path + angle_of_attack() * std::cos(bank_) + pitch_noise_.at(distance_);
}

RolloutPose Airliner::pose() const {
  RolloutPose pose;
  pose.position = position_;
  // In a banked turn the angle of attack turns the nose into the turn: no side wind on the hull.
  const double heading = heading_ + angle_of_attack() * std::sin(bank_);
  pose.euler = {bank_ + roll_noise_.at(distance_), pitch(), heading};
  return pose;
}

}  // namespace foucault::simulation
