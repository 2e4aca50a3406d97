#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/core/time.h"
#include "foucault/navigation/gap_options.h"
#include "foucault/state/result.h"

namespace foucault::navigation {

/// Change of heading over a hole in the IMU data, positive to the right.
struct HoleTurn {
  double angle = 0;  ///< [rad]
  double sigma = 0;  ///< [rad]
};

/// Both ends of a hole.
struct ImuHole {
  state::Epoch before;                                       ///< state where the data end
  Eigen::Vector3d gyro_before_b = Eigen::Vector3d::Zero();   ///< mean rates there [rad/s]
  Eigen::Vector3d accel_before_b = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double interval = 0;                                       ///< length of increments there [s]
  ImuIncrement after;                                        ///< the first increment after it
  std::optional<HoleTurn> turn;

  double length() const { return seconds_between(before.t_ns, after.t_begin_ns); }  ///< [s]
  /// Of what is made up for it: as long as increments before it, at most kMostSteps of them.
  int64_t step_ns() const;
};

/// What the course tells about a hole: the course before it from the state's velocity, the course
/// after it from fixes there, less what the gyroscopes have turned since. `after` is the stream
/// from the first increment after the hole on. None while there are too few fixes, or when the
/// vehicle is too slow, or the fixes too coarse.
std::optional<HoleTurn> turn_over(const ImuHole& hole, const std::deque<Measurement>& after);

/// Fills [t_begin, t_end] of a hole: rates interpolated between its ends, or, where the turn is
/// known, shifted so that they make it, with the centripetal force that goes with the shift.
/// Extra noise: white noise of density s sqrt(T) adds up to what a constant error s does over T.
ImuIncrement made_up_increment(const ImuHole& hole, const GapOptions& options, int64_t t_begin_ns,
                               int64_t t_end_ns);

}  // namespace foucault::navigation
