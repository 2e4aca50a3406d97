#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "foucault/simulation/random.h"
#include "rollout.h"

namespace foucault::simulation {

/// What a vehicle does for a while: it comes to the speed on a straight course, then turns.
struct Leg {
  double seconds = 0;  ///< from when the speed is reached
  double speed = 0;    ///< [m/s]
  double turn = 0;     ///< of the course within the seconds, right positive [rad]
  double yaw = 0;      ///< of the nose within the seconds, beyond the turn [rad]
  /// Course less heading from here on [rad]. Only a vehicle that stands can set out anywhere.
  std::optional<double> direction;
  double altitude = 0;  ///< above the start [m]
};

/// How a vehicle moves and leans. What shakes it goes by the distance, so that it stops with it.
struct VehicleStyle {
  double acceleration = 0;       ///< of the speed [m/s^2]
  double turn_acceleration = 0;  ///< of course and nose [rad/s^2]
  double climb_rate = 0;         ///< [m/s]
  /// Parts of the angles that bring the specific force back to the vehicle's vertical. 1: as a
  /// multirotor and in a coordinated turn; below 0: the body leans outward, the nose rises.
  double roll_lean = 0, pitch_lean = 0;
  bool nose_follows_climb = false;                   ///< as an aircraft's does
  Eigen::Vector2d wind_n = Eigen::Vector2d::Zero();  ///< carries what flies in it [m/s]
  SineSum hills{{}};                                 ///< height of the ground, which tilts it [m]
  SineSum right{{}}, up{{}};                         ///< of the body on its way [m]
  SineSum roll{{}}, pitch{{}}, yaw{{}};              ///< [rad]
  std::vector<Leg> first;                            ///< after the rest
  std::function<std::vector<Leg>(Draws&)> next;      ///< then, again and again
};

/// A vehicle that goes leg by leg.
class Vehicle : public Rollout {
 public:
  Vehicle(VehicleStyle style, const ScenarioOptions& options);
  RolloutPose pose() const override;
  void advance(double dt) override;

 private:
  void begin_leg();
  void steer(double dt);
  void climb(double dt);
  void move(double dt);
  double nose() const { return course_ - crab_; }

  VehicleStyle style_;
  Draws draws_;
  std::deque<Leg> legs_;  ///< the current one first
  Geodetic position_;     ///< on the ground or at the altitude, not shaken
  double start_height_;
  double course_;           ///< of the motion through the air or over the ground [rad]
  double crab_ = 0;         ///< course less nose [rad]
  double in_leg_ = 0;       ///< [s]
  double speed_ = 0;        ///< [m/s]
  double course_rate_ = 0;  ///< [rad/s]
  double crab_rate_ = 0;    ///< [rad/s]
  double altitude_ = 0;     ///< [m]
  double climb_ = 0;        ///< [m/s]
  double lift_ = 0;         ///< upward acceleration [m/s^2]
  double distance_ = 0;     ///< [m]
  Eigen::Vector2d velocity_n_ = Eigen::Vector2d::Zero();      ///< [m/s]
  Eigen::Vector2d acceleration_n_ = Eigen::Vector2d::Zero();  ///< [m/s^2]
};

}  // namespace foucault::simulation
