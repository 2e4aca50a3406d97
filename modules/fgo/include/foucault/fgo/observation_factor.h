#pragma once

#include <ceres/cost_function.h>

#include "foucault/fgo/graph_context.h"
#include "foucault/fgo/state_block.h"
#include "foucault/measurement/observation.h"

namespace foucault::fgo {

/// An observation at a node.
struct NodeObservation {
  measurement::ObservationPtr observation;
  measurement::MeanMotion mean;  ///< about its stamp
};

/// Whitened rows, predicted minus measured, in the local NED of the place; columns by w.
/// The turning of that NED with the place is left out: 0.16 mrad a km.
/// Throws std::invalid_argument if the covariance is not positive definite.
ObservationRows linearize(const NodeObservation& z, const state::NodeState& x,
                          const state::SlowVector& slow, const GraphContext& context);

/// The same for Ceres. Blocks: node, and border if there is one.
class ObservationFactor final : public ceres::CostFunction {
 public:
  /// (x, slow): a state to tell the number of rows. `context` lives as long as this.
  ObservationFactor(const NodeObservation& z, const state::NodeState& x,
                    const state::SlowVector& slow, const GraphContext& context);

  ObservationRows linearize(const state::NodeState& x, const state::SlowVector& slow) const {
    return fgo::linearize(z_, x, slow, *context_);
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override;

 private:
  NodeObservation z_;
  const GraphContext* context_;
};

}  // namespace foucault::fgo
