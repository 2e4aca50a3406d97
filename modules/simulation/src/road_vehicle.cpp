#include "road_vehicle.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::simulation {
namespace {

constexpr double kSight = 400;                       ///< a driver sees so far [m]
constexpr double kMaxLateral = 3.0;                  ///< in turns [m/s^2]
constexpr double kMaxYawRate = 33 * kDegree;         ///< in turns [rad/s]
constexpr double kMaxBraking = 3.0;                  ///< [m/s^2]
constexpr double kRollPerLateral = -0.4 * kDegree;   ///< body leans out of the turn [rad/(m/s^2)]
constexpr double kPitchPerForward = 0.35 * kDegree;  ///< nose up when it accelerates
constexpr double kSuspensionLag = 0.3;               ///< [s]
constexpr double kSlipsFreely = 3;                   ///< slower, the slip shrinks alike [m/s]

/// Speed at which a section is driven [m/s].
double section_speed(const RoadSection& section) {
  const double curvature = section.length > 0 ? 2 * std::abs(section.turn) / section.length : 0;
  if (curvature == 0) return section.speed;
  return std::min({section.speed, std::sqrt(kMaxLateral / curvature), kMaxYawRate / curvature});
}

}  // namespace

RoadStyle city_style() {
  RoadStyle style;
  style.min_length = 100, style.max_length = 600;
  style.min_speed = 11, style.max_speed = 16;
  style.bend_probability = 0.4;
  style.min_bend = 3 * kDegree, style.max_bend = 25 * kDegree;
  style.turn_probability = 0.5;
  style.stop_probability = 0.25;
  style.min_radius = 9, style.max_radius = 18;
  style.max_deviation = 4 * kPi;
  style.acceleration = 1.8, style.braking = 1.8;
  return style;
}

RoadStyle motorway_style() {
  RoadStyle style;
  style.min_length = 600, style.max_length = 2500;
  style.min_speed = 29, style.max_speed = 32;
  style.bend_probability = 0.7;
  style.min_bend = 2 * kDegree, style.max_bend = 20 * kDegree;
  style.turn_probability = 0;
  style.stop_probability = 0;
  style.min_radius = 0, style.max_radius = 0;
  style.max_deviation = 30 * kDegree;
  style.acceleration = 1.2, style.braking = 1.0;
  return style;
}

Road::Road(const RoadStyle& style, int64_t seed, double rest_s)
    : style_(style), draws_(seed, RandomStream::motion) {
  RoadSection rest;
  rest.stop_s = rest_s;
  planned_.push_back(rest);
}

RoadSection Road::next() {
  if (planned_.empty()) {
    planned_.push_back(between_junctions());
    if (draws_.happens(style_.turn_probability)) planned_.push_back(right_angle());
  }
  const RoadSection section = planned_.front();
  planned_.pop_front();
  return section;
}

RoadSection Road::between_junctions() {
  RoadSection section;
  section.length = draws_.uniform(style_.min_length, style_.max_length);
  section.speed = draws_.uniform(style_.min_speed, style_.max_speed);
  if (draws_.happens(style_.bend_probability)) {
    section.turn = bend_sign() * draws_.uniform(style_.min_bend, style_.max_bend);
    deviation_ += section.turn;
  }
  if (draws_.happens(style_.stop_probability)) section.stop_s = draws_.uniform(5, 30);
  return section;
}

RoadSection Road::right_angle() {
  RoadSection section;
  section.turn = bend_sign() * draws_.uniform(80 * kDegree, 100 * kDegree);
  section.length =
      2 * std::abs(section.turn) * draws_.uniform(style_.min_radius, style_.max_radius);
  section.speed = style_.max_speed;
  deviation_ += section.turn;
  return section;
}

double Road::bend_sign() {
  if (std::abs(deviation_) > style_.max_deviation) return deviation_ > 0 ? -1 : 1;
  return draws_.sign();
}

RoadVehicle::RoadVehicle(const RoadStyle& style, const ScenarioOptions& options)
    : style_(style),
      road_(style, options.seed, options.rest_s),
      position_(options.start_position()),
      start_height_(options.height_m),
      heading_(start_heading(options)),
      slip_sigma_(options.slip_sigma_m_s),
      slip_tau_(options.slip_tau_s),
      slip_per_lateral_(options.slip_rad_per_m_s2),
      slip_draws_(options.seed, RandomStream::slip),
      slip_(slip_draws_.normal()),
      hills_({}),
      bumps_({}),
      roll_noise_({}),
      pitch_noise_({}) {
  Draws draws(options.seed, RandomStream::surface);
  hills_ =
      SineSum({{4.5, 2500, draws.phase()}, {2.5, 1200, draws.phase()}, {1, 600, draws.phase()}});
  bumps_ = SineSum({{0.004, 17, draws.phase()}, {0.006, 31, draws.phase()}});
  roll_noise_ = SineSum({{0.15 * kDegree, 23, draws.phase()}, {0.3 * kDegree, 190, draws.phase()}});
  pitch_noise_ = SineSum({{0.1 * kDegree, 19, draws.phase()}, {0.15 * kDegree, 47, draws.phase()}});
  look_ahead();
}

void RoadVehicle::look_ahead() {
  double seen = -along_;
  for (const RoadSection& section : sections_) seen += section.length;
  while (seen < kSight || sections_.size() < 2) {
    sections_.push_back(road_.next());
    seen += sections_.back().length;
  }
}

RolloutPose RoadVehicle::pose() const {
  const double lateral = speed_ * yaw_rate_;
  RolloutPose pose;
  pose.position = position_;
  pose.euler.x() = kRollPerLateral * lateral + roll_noise_.at(distance_);
  pose.euler.y() = std::atan(hills_.slope(distance_)) + kPitchPerForward * acceleration_ +
                   pitch_noise_.at(distance_);
  pose.euler.z() = heading_ - slip_angle();
  return pose;
}

double RoadVehicle::slip_angle() const {
  return std::atan(slip_sigma_ * slip_ / std::max(speed_, kSlipsFreely)) +
         slip_per_lateral_ * speed_ * yaw_rate_;
}

double RoadVehicle::curvature() const {
  const RoadSection& section = sections_.front();
  if (section.turn == 0) return 0;
  return section.turn / section.length * (1 - std::cos(2 * kPi * along_ / section.length));
}

double RoadVehicle::allowed_speed() const {
  double allowed = section_speed(sections_.front());
  double ahead = -along_;
  for (std::size_t i = 0; i < sections_.size() && ahead < kSight; ++i) {
    ahead += sections_[i].length;
    const bool stops = sections_[i].stop_s > 0;
    const bool last = i + 1 == sections_.size();
    if (last && !stops) break;
    const double target = stops ? 0 : section_speed(sections_[i + 1]);
    allowed =
        std::min(allowed, std::sqrt(target * target + 2 * style_.braking * std::max(0.0, ahead)));
    if (stops) break;
  }
  return allowed;
}

void RoadVehicle::leave_section() {
  const double beyond = along_ - sections_.front().length;
  sections_.pop_front();
  along_ = std::max(0.0, beyond);
  look_ahead();
}

void RoadVehicle::stand(double dt) {
  speed_ = 0;
  yaw_rate_ = 0;
  acceleration_ -= acceleration_ * dt / kSuspensionLag;
  standing_s_ += dt;
  if (standing_s_ >= sections_.front().stop_s) {
    standing_s_ = 0;
    along_ = sections_.front().length;
    leave_section();
  }
}

void RoadVehicle::drive(double dt) {
  const double wanted = (allowed_speed() - speed_) / dt;
  const double acceleration = std::clamp(wanted, -kMaxBraking, style_.acceleration);
  speed_ = std::max(0.0, speed_ + acceleration * dt);
  yaw_rate_ = speed_ * curvature();
  acceleration_ += (acceleration - acceleration_) * dt / kSuspensionLag;

  const double step = speed_ * dt;
  const double mid_heading = heading_ + yaw_rate_ * dt / 2;
  move_along_earth(position_, step * std::cos(mid_heading), step * std::sin(mid_heading));
  heading_ += yaw_rate_ * dt;
  along_ += step;
  distance_ += step;
  slip_ = next_markov(slip_, dt / slip_tau_, slip_draws_.normal());
  position_.height =
      start_height_ + hills_.at(distance_) - hills_.at(0) + bumps_.at(distance_) - bumps_.at(0);
}

void RoadVehicle::advance(double dt) {
  const RoadSection& section = sections_.front();
  const bool at_stop_line = section.stop_s > 0 && section.length - along_ < 0.01;
  if (at_stop_line) {
    stand(dt);
    return;
  }
  drive(dt);
  if (section.stop_s == 0 && along_ >= section.length) leave_section();
}

}  // namespace foucault::simulation
