#pragma once

#include <Eigen/Core>
#include <memory>

#include "foucault/core/measurement.h"
#include "foucault/measurement/observation.h"
#include "foucault/state/epoch.h"

namespace foucault::measurement {

/// What an integration filter does once it has an initial state. The driver (NavigationRun) deals
/// with alignment, splitting, gaps, gating and output, the same for every method.
/// Calls: start(), then propagate() over increments each of which begins where the last ended;
/// between them, at the current time, innovation()/update(), hold() and epoch().
class Navigator {
 public:
  virtual ~Navigator() = default;

  /// (Re)starts from a state with covariance, at initial.t_ns. Slow blocks that it has keep their
  /// values and correlations; those that it lacks start from their prior.
  virtual void start(const state::Epoch& initial) = 0;

  virtual void propagate(const ImuIncrement& increment) = 0;

  /// Prediction error of a measurement at the current time; changes nothing.
  virtual state::Innovation innovation(const Observation& observation) const = 0;

  /// Uses a measurement at the current time.
  virtual void update(const ObservationPtr& observation) = 0;

  /// The state may be worse than its covariance says: `added` comes to that of the node's blocks at
  /// the current time, position and velocity in the local NED. Symmetric, positive semidefinite.
  /// Slow blocks keep their values and correlations.
  virtual void loosen(const state::NodeMatrix& added) = 0;

  /// One that drives on from the present state by the same method, for trying out what follows,
  /// with the sigmas of all that is estimated `scale` times what they are; correlations stay. This
  /// one is not changed. The other leaves no nodes, and need not remember what came before.
  virtual std::unique_ptr<Navigator> ahead(double scale) const = 0;

  /// No fix has come for node_interval: a factor graph adds a node here, a filter does nothing.
  virtual void hold() = 0;

  /// The best estimate at the current time.
  virtual state::Epoch epoch() const = 0;
};

}  // namespace foucault::measurement
