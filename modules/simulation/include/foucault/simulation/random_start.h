#pragma once

#include <string>

#include "foucault/simulation/scenario.h"

namespace foucault::simulation {

/// A recording that an alignment must find into: what moves, its sensors, and where in the trip the
/// recording begins.
struct RandomStart {
  ScenarioOptions scenario;
  std::string imu;  ///< preset
};

/// Draws, alike often:
/// - walk, robot, boat, car forward and reversing, multirotor, fixed wing, train, tractor;
/// - RTK of 1 to 2 cm, or single fixes of 1.5 to 3 m without or with a velocity of 0.05 to 0.2 m/s,
///   at 0.2 to 10 Hz (the logarithm is uniform);
/// - a beginning at rest for 5 to 40 s, in motion, or turning;
/// - the IMU among the presets, heading, place and lever arm.
/// 180 s long. The same seed gives the same start, and a seed of its own everything else.
RandomStart random_start(int64_t seed);

}  // namespace foucault::simulation
