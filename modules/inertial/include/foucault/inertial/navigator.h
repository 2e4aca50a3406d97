#pragma once

#include <Eigen/Core>
#include <memory>

#include "foucault/core/measurement.h"
#include "foucault/state/result.h"

namespace foucault {

struct Innovation {
  Eigen::Vector3d value_n = Eigen::Vector3d::Zero();         ///< fix minus prediction, NED [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of value_n, fix noise included
};

/// What an integration filter does once it has an initial state. The driver (NavigationRun) deals
/// with alignment, splitting, gaps, gating and output, the same for every method.
/// Calls: start(), then propagate() over increments each of which begins where the last ended;
/// between them, at the current time, innovation()/update(), hold() and epoch().
class Navigator {
 public:
  virtual ~Navigator() = default;

  /// (Re)starts from a state with covariance, at initial.t_ns.
  virtual void start(const Epoch& initial) = 0;

  virtual void propagate(const ImuIncrement& increment) = 0;

  /// Prediction error of a fix at the current time; changes nothing.
  virtual Innovation innovation(const GnssFix& fix) const = 0;

  /// Uses a fix at the current time.
  virtual void update(const GnssFix& fix) = 0;

  /// The state may be worse than its covariance says: `added` comes to it at the current time, in
  /// the order of error_state, position and velocity in the local NED. Symmetric, positive
  /// semidefinite. What is estimated beside these fifteen keeps its values and correlations.
  virtual void loosen(const Matrix15d& added) = 0;

  /// One that drives on from the present state by the same method, for trying out what follows,
  /// with the sigmas of all that is estimated `scale` times what they are; correlations stay. This
  /// one is not changed. The other leaves no nodes, and need not remember what came before.
  virtual std::unique_ptr<Navigator> ahead(double scale) const = 0;

  /// No fix has come for node_interval: a factor graph adds a node here, a filter does nothing.
  virtual void hold() = 0;

  /// The best estimate at the current time.
  virtual Epoch epoch() const = 0;
};

}  // namespace foucault
