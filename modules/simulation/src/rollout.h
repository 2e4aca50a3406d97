#pragma once

#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/simulation/scenario.h"

/// Inside of the simulation: kinematic roll-outs that give the control points of a Trajectory.
/// A roll-out need not be exact; the splines that follow it are the truth.
namespace foucault::simulation {

/// Pose of the vehicle at a knot.
struct RolloutPose {
  Geodetic position;
  Eigen::Vector3d euler = Eigen::Vector3d::Zero();  ///< roll, pitch, heading [rad], no jumps
};

/// A vehicle that is stepped through time.
class Rollout {
 public:
  virtual ~Rollout() = default;
  virtual RolloutPose pose() const = 0;
  /// Goes on by dt [s]; a few tens of milliseconds at most.
  virtual void advance(double dt) = 0;
};

/// Sum of sines of one argument.
class SineSum {
 public:
  struct Term {
    double amplitude;
    double wavelength;  ///< unit of the argument
    double phase;       ///< [rad]
  };
  explicit SineSum(std::vector<Term> terms) : terms_(std::move(terms)) {}
  double at(double x) const;
  double slope(double x) const;

 private:
  std::vector<Term> terms_;
};

/// `value` on its way to `target`, by `step` at most.
double toward(double value, double target, double step);

/// Moves by north and east [m] along the ellipsoid.
void move_along_earth(Geodetic& position, double north, double east);

/// Start heading [rad]: as given or from the seed.
double start_heading(const ScenarioOptions& options);

}  // namespace foucault::simulation
