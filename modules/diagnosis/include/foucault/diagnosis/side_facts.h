#pragma once

#include <Eigen/Core>
#include <optional>

#include "foucault/diagnosis/acceleration_match.h"
#include "foucault/diagnosis/force_facts.h"
#include "foucault/diagnosis/turn_match.h"

/// Which of gyroscopes, accelerometers and track is mirrored?
namespace foucault::diagnosis {

/// Whether the mean specific force, in v, points down where it should point up.
bool is_upside_down(const Eigen::Vector3d& mean_force);

/// Whether turns by the gyroscopes are against those of the course, more than chance makes them.
bool turns_against(const TurnMatch& turns);

/// What is mirrored, and what to do; none if nothing is. An accelerometer of the opposite sign
/// turns up over, and with it the sense of all turns about up: then turns and forces are on the
/// wrong side, and forward is backward. On a mirrored track turns and forces are on the wrong side,
/// and forward is forward. Where forces do not tell, both are named.
std::optional<WrongForce> wrong_side(const TurnMatch& turns,
                                     const std::optional<AccelerationFit>& accelerations,
                                     const Eigen::Vector3d& mean_force);

}  // namespace foucault::diagnosis
