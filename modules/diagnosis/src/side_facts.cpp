#include "foucault/diagnosis/side_facts.h"

#include <fmt/format.h>

#include <cmath>

#include "foucault/core/constants.h"

namespace foucault::diagnosis {
namespace {

constexpr double kQuarter = kPi / 4;
/// Of accelerations, where they tell a side against the gyroscopes; cars and an aerobatic flight
/// have 0.95 and more.
constexpr double kForcesAgree = 0.9;

WrongForce opposite_sign(const std::string& seen, bool upside_down) {
  return {"the accelerometer has the opposite sign: " + seen,
          upside_down ? "imu: {accel_sign: -1} in the import's mapping; leave the axes"
                      : "imu: {accel_sign: -1} in the import's mapping, with axes that then have "
                        "up upwards"};
}

}  // namespace

bool is_upside_down(const Eigen::Vector3d& mean_force) {
  return mean_force.z() > 0.5 * mean_force.norm();
}

bool turns_against(const TurnMatch& turns) {
  constexpr double kChance = 5;  // sigmas of a correlation; the best of 100 offsets
  const double r = turns.correlation;
  return r < 0 && r * r * static_cast<double>(turns.samples) > kChance * kChance * (1 - r * r);
}

std::optional<WrongForce> wrong_side(const TurnMatch& turns,
                                     const std::optional<AccelerationFit>& accelerations,
                                     const Eigen::Vector3d& mean_force) {
  const bool is_side_known = accelerations && accelerations->is_side_known;
  const bool mirrored = is_side_known && accelerations->mirrored;
  if (!turns_against(turns)) {
    if (!mirrored || accelerations->correlation < kForcesAgree) return std::nullopt;
    return WrongForce{"the specific force is on the other side than turns are",
                      "correct the signs of the accelerometer's axes in the import"};
  }
  const std::string against = fmt::format(
      "the gyroscopes turn against the course of GNSS, correlation {:.2f} in {} courses",
      turns.correlation, turns.samples);
  const bool upside_down = is_upside_down(mean_force);
  if (upside_down) return opposite_sign("up is not up, and so " + against, true);
  const double angle = accelerations ? std::abs(accelerations->angle.value) : 0;
  if (mirrored && angle > kPi - kQuarter) {
    return opposite_sign(against + ", and forces are against its accelerations", false);
  }
  if (mirrored && angle < kQuarter) {
    return WrongForce{against + ", and so do the accelerometers: the track is mirrored",
                      "latitude and longitude, or north and east, are swapped, or one has lost its "
                      "sign; correct the columns of the import"};
  }
  if (is_side_known && !mirrored) {
    return WrongForce{against + ", and the accelerometers do not",
                      "correct the signs of the gyroscopes in the import"};
  }
  return WrongForce{
      against,
      "latitude and longitude, or north and east, are swapped (a mirrored track looks "
      "the same), or the axes are wrong; correct the columns or the axes of the "
      "import (imu.axes of the mapping, or the sensorPose)"};
}

}  // namespace foucault::diagnosis
