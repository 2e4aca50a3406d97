#pragma once

#include <cstdint>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/preintegration/motion.h"
#include "foucault/simulation/trajectory.h"

/// A piece of an exact motion as a perfect IMU (axes b = v, no noise, no bias) sees it.
/// Stamps count from the start of the trajectory.
namespace foucault::laboratory {

/// True state at t [s], in the w of `frame`. Good to 1 nm, the rounding of ECEF metres.
state::NodeState true_state(const simulation::Trajectory& trajectory,
                            const geodesy::LocalFrame& frame, double t);

/// Exact increments of one interval at any rate that divides a base rate.
class ExactIncrements {
 public:
  /// Over (begin, begin + length] [s]; `coarsest_rate_hz` tells how far before `begin` they reach.
  ExactIncrements(const simulation::Trajectory& trajectory, double begin, double length,
                  double base_rate_hz, double coarsest_rate_hz);

  /// The first one ends at `begin`: for coning and sculling.
  /// Throws std::invalid_argument if the rate does not divide the base rate or is too low.
  std::vector<ImuIncrement> at(double rate_hz) const;

 private:
  double base_rate_hz_;
  std::size_t before_;  ///< base increments before `begin`
  std::vector<ImuIncrement> base_;
};

}  // namespace foucault::laboratory
