#pragma once

#include "foucault/simulation/random.h"
#include "rollout.h"

namespace foucault::simulation {

/// An airliner: stands, takes off, climbs at 12 m/s, cruises at 250 m/s, makes coordinated turns,
/// descends, lands and stops at the height it started from. A short flight stays low, one of less
/// than ten minutes ends in the climb.
class Airliner : public Rollout {
 public:
  explicit Airliner(const ScenarioOptions& options);
  RolloutPose pose() const override;
  void advance(double dt) override;

 private:
  bool flies() const { return altitude_ > 0.1; }
  bool descends() const;
  double wanted_speed() const;
  double wanted_climb() const;
  double wanted_bank();
  double bank_for_remaining_turn() const;
  void plan_turn();
  double angle_of_attack() const;
  double pitch() const;

  double rest_s_;
  double duration_s_;
  double start_height_;
  double cruise_altitude_;
  Draws draws_;
  Geodetic position_;
  double first_heading_;
  double heading_;
  double time_ = 0;
  double altitude_ = 0;   ///< above the runway [m]
  double speed_ = 0;      ///< horizontal [m/s]
  double climb_ = 0;      ///< [m/s]
  double bank_ = 0;       ///< [rad]
  double turn_left_ = 0;  ///< change of heading still to make [rad]
  double turn_bank_ = 0;  ///< of the turn under way [rad]
  double next_turn_s_ = 0;
  double distance_ = 0;                       ///< since the start [m]
  SineSum bumps_, roll_noise_, pitch_noise_;  ///< by distance
};

}  // namespace foucault::simulation
