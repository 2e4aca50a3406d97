#include "foucault/fgo/observation_factor.h"

#include <Eigen/Cholesky>
#include <stdexcept>
#include <string>

#include "node_epoch.h"

namespace foucault::fgo {

ObservationRows linearize(const NodeObservation& z, const state::NodeState& x,
                          const state::SlowVector& slow, const GraphContext& context) {
  const LocalNode node = to_nav(x, slow, context);
  const state::Linearized in_n = z.observation->linearize(node.x, z.mean, context.layout);
  const auto llt = in_n.R.llt();
  if (llt.info() != Eigen::Success)
    throw std::invalid_argument("covariance of " + std::string(z.observation->name()) +
                                " is not positive definite");
  ObservationRows rows{-in_n.r, in_n.H};
  for (const state::NodeBlock& turned : {state::block::position, state::block::velocity})
    state::columns_of(rows.J, turned) = (state::columns_of(in_n.H, turned) * node.R_n_w).eval();
  llt.matrixL().solveInPlace(rows.r);
  llt.matrixL().solveInPlace(rows.J);
  return rows;
}

ObservationFactor::ObservationFactor(const NodeObservation& z, const state::NodeState& x,
                                     const state::SlowVector& slow, const GraphContext& context)
    : z_(z), context_(&context) {
  set_num_residuals(static_cast<int>(linearize(x, slow).r.size()));
  *mutable_parameter_block_sizes() = block_sizes(1, slow.size());
}

bool ObservationFactor::Evaluate(double const* const* blocks, double* residual,
                                 double** jacobians) const {
  const ObservationRows rows = linearize(read_block(blocks[0]), read_border(*this, blocks));
  write_rows(rows, blocks, residual, jacobians);
  return true;
}

}  // namespace foucault::fgo
