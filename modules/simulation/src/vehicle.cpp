#include "vehicle.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::simulation {
namespace {

constexpr double kVertical = 1;       ///< up and down [m/s^2]
constexpr double kAltitudeLag = 3;    ///< time constant of reaching an altitude [s]
constexpr double kFlyingSpeed = 15;   ///< from here on the wind carries an aircraft wholly [m/s]
constexpr double kLeastForward = 10;  ///< slower, a climb does not raise the nose more [m/s]

Eigen::Vector2d along(double angle) { return {std::cos(angle), std::sin(angle)}; }

double risen(const SineSum& sum, double distance) { return sum.at(distance) - sum.at(0); }

}  // namespace

Vehicle::Vehicle(VehicleStyle style, const ScenarioOptions& options)
    : style_(std::move(style)),
      draws_(options.seed, RandomStream::motion),
      position_(options.start_position()),
      start_height_(options.height_m),
      course_(start_heading(options)) {
  Leg rest;
  rest.seconds = options.rest_s;
  legs_.push_back(rest);
  legs_.insert(legs_.end(), style_.first.begin(), style_.first.end());
}

void Vehicle::begin_leg() {
  legs_.pop_front();
  if (legs_.empty()) {
    const std::vector<Leg> next = style_.next(draws_);
    legs_.assign(next.begin(), next.end());
  }
  in_leg_ = 0;
  if (legs_.front().direction) {
    course_ = nose() + *legs_.front().direction;
    crab_ = *legs_.front().direction;
  }
}

void Vehicle::steer(double dt) {
  const Leg& leg = legs_.front();
  const bool at_speed = speed_ == leg.speed;
  const double share = at_speed ? 1 / leg.seconds : 0.0;
  const double step = style_.turn_acceleration * dt;
  speed_ = toward(speed_, leg.speed, style_.acceleration * dt);
  course_rate_ = toward(course_rate_, share * leg.turn, step);
  crab_rate_ = toward(crab_rate_, -share * leg.yaw, step);
  course_ += course_rate_ * dt;
  crab_ += crab_rate_ * dt;
  if (at_speed) in_leg_ += dt;
}

void Vehicle::climb(double dt) {
  const double wanted = std::clamp((legs_.front().altitude - altitude_) / kAltitudeLag,
                                   -style_.climb_rate, style_.climb_rate);
  const double before = climb_;
  climb_ = toward(climb_, wanted, kVertical * dt);
  lift_ = (climb_ - before) / dt;
  altitude_ += climb_ * dt;
}

void Vehicle::move(double dt) {
  const Eigen::Vector2d before = velocity_n_;
  velocity_n_ = speed_ * along(course_) + std::min(1.0, speed_ / kFlyingSpeed) * style_.wind_n;
  acceleration_n_ = (velocity_n_ - before) / dt;
  distance_ += speed_ * dt;
  move_along_earth(position_, velocity_n_.x() * dt, velocity_n_.y() * dt);
  position_.height = start_height_ + altitude_ + risen(style_.hills, distance_);
}

void Vehicle::advance(double dt) {
  while (in_leg_ >= legs_.front().seconds) begin_leg();
  steer(dt);
  climb(dt);
  move(dt);
}

RolloutPose Vehicle::pose() const {
  const double heading = nose() + risen(style_.yaw, distance_);
  const double forward = acceleration_n_.dot(along(heading));
  const double right = acceleration_n_.dot(along(heading + kPi / 2));
  const double upward = kStandardGravity + lift_;
  const double path = style_.nose_follows_climb
                          ? std::atan2(climb_, std::max(speed_, kLeastForward))
                          : std::atan(style_.hills.slope(distance_)) * std::cos(crab_);
  RolloutPose pose;
  pose.position = position_;
  pose.position.height += risen(style_.up, distance_);
  const Eigen::Vector2d aside = risen(style_.right, distance_) * along(heading + kPi / 2);
  move_along_earth(pose.position, aside.x(), aside.y());
  pose.euler.x() =
      style_.roll_lean * std::atan2(right, std::hypot(forward, upward)) + style_.roll.at(distance_);
  pose.euler.y() =
      path - style_.pitch_lean * std::atan2(forward, upward) + style_.pitch.at(distance_);
  pose.euler.z() = heading;
  return pose;
}

}  // namespace foucault::simulation
