#pragma once

#include <deque>

#include "foucault/simulation/random.h"
#include "rollout.h"

namespace foucault::simulation {

/// A piece of road. Its curvature is 1 - cos over the length, so that it joins its neighbours
/// without a step: peak curvature 2 |turn| / length.
struct RoadSection {
  double length = 0;  ///< [m]
  double turn = 0;    ///< change of heading, right positive [rad]
  double speed = 0;   ///< a driver's speed on it if straight [m/s]
  double stop_s = 0;  ///< standing at its end [s]
};

/// What roads and drivers are like.
struct RoadStyle {
  double min_length, max_length;  ///< of a section between junctions [m]
  double min_speed, max_speed;    ///< [m/s]
  double bend_probability;        ///< that such a section bends
  double min_bend, max_bend;      ///< [rad]
  double turn_probability;        ///< that a junction is a right-angle turn
  double stop_probability;        ///< that a junction has a red light
  double min_radius, max_radius;  ///< of right-angle turns [m]
  double max_deviation;           ///< a road further off its first heading turns back [rad]
  double acceleration, braking;   ///< [m/s^2]
};

RoadStyle city_style();
RoadStyle motorway_style();

/// Draws a road without end.
class Road {
 public:
  Road(const RoadStyle& style, int64_t seed, double rest_s);
  RoadSection next();

 private:
  RoadSection between_junctions();
  RoadSection right_angle();
  double bend_sign();

  RoadStyle style_;
  Draws draws_;
  std::deque<RoadSection> planned_;
  double deviation_ = 0;  ///< from the first heading [rad]
};

/// A car that follows a road: slows for turns and lights, rolls, pitches and bounces a little.
/// Its position is of the point that does not slip, whose course the heading is, but for slip_*.
class RoadVehicle : public Rollout {
 public:
  RoadVehicle(const RoadStyle& style, const ScenarioOptions& options);
  RolloutPose pose() const override;
  void advance(double dt) override;

 private:
  void look_ahead();
  double allowed_speed() const;
  double curvature() const;
  double slip_angle() const;
  void leave_section();
  void stand(double dt);
  void drive(double dt);

  RoadStyle style_;
  Road road_;
  std::deque<RoadSection> sections_;  ///< the current one and what the driver sees
  Geodetic position_;
  double start_height_;
  double heading_;           ///< of the course [rad]
  double along_ = 0;         ///< in the current section [m]
  double distance_ = 0;      ///< since the start [m]
  double speed_ = 0;         ///< [m/s]
  double acceleration_ = 0;  ///< low-passed [m/s^2]
  double yaw_rate_ = 0;      ///< [rad/s]
  double standing_s_ = 0;
  double slip_sigma_, slip_tau_;  ///< [m/s], [s]
  double slip_per_lateral_;       ///< [rad/(m/s^2)]
  Draws slip_draws_;
  double slip_;  ///< in units of slip_sigma_; stays as it is while the car stands
  SineSum hills_, bumps_, roll_noise_, pitch_noise_;  ///< by distance
};

}  // namespace foucault::simulation
