#include "chain_problem.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace foucault::fgo {
namespace {

/// Radius of the trust region: the start is good most of the time, and a plain step the best.
constexpr double kGaussNewton = 1e16;
/// Up to so many nodes a dense factorization is the faster one.
constexpr std::size_t kDenseNodes = 4;

ceres::Solver::Options solver_options(const FgoOptions& options, std::size_t nodes) {
  ceres::Solver::Options solver;
  solver.linear_solver_type =
      nodes > kDenseNodes ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_NORMAL_CHOLESKY;
  solver.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  solver.initial_trust_region_radius = kGaussNewton;
  solver.max_trust_region_radius = 1e32;
  solver.max_num_iterations = static_cast<int>(options.max_iterations);
  solver.function_tolerance = 1e-7;
  solver.gradient_tolerance = 0;
  solver.parameter_tolerance = 0;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

/// The first summary is of the start.
int64_t iterations(const ceres::Solver::Summary& summary) {
  return std::max<int64_t>(0, static_cast<int64_t>(summary.iterations.size()) - 1);
}

/// Stops when the step that was taken is known to be the last one that matters. If the quadratic
/// model missed the change of cost by a share e, the gradient left is of order e and the cost left
/// e^2 of the change; at 1e-6, a step of another thousandth of a sigma. Without this every solve
/// ends with an iteration that only confirms.
class StopWhenModelHolds final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    constexpr double kCostMissed = 1e-6;
    const double missed = 1 - iteration.relative_decrease;
    const bool done = iteration.iteration > 0 && iteration.step_is_successful &&
                      missed * missed * std::abs(iteration.cost_change) < kCostMissed;
    return done ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
};

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

}  // namespace

ChainProblem::ChainProblem(const state::NodeState& first, const state::SlowVector& slow,
                           PriorFactor& prior, ceres::LossFunction* loss)
    : loss_(loss), slow_(slow), problem_(problem_options()) {
  problem_.AddResidualBlock(&prior, nullptr, with_border({add_block(first)}));
}

double* ChainProblem::add_block(const state::NodeState& x) {
  StateBlock& block = blocks_.emplace_back();
  write_block(x, block.data());
  problem_.AddParameterBlock(block.data(), kStateBlockSize, &manifold_);
  return block.data();
}

std::vector<double*> ChainProblem::with_border(std::vector<double*> nodes) {
  if (slow_.size() > 0) nodes.push_back(slow_.data());
  return nodes;
}

void ChainProblem::add_node(const state::NodeState& x, PreintegrationFactor& interval) {
  double* const before = blocks_.back().data();
  problem_.AddResidualBlock(&interval, nullptr, with_border({before, add_block(x)}));
}

void ChainProblem::add(ObservationFactor& observation) {
  problem_.AddResidualBlock(&observation, loss_, with_border({blocks_.back().data()}));
}

int64_t ChainProblem::optimize(const FgoOptions& options) {
  StopWhenModelHolds stop;
  ceres::Solver::Options solver = solver_options(options, size());
  solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem_, &summary);
  int64_t taken = iterations(summary);
  if (summary.termination_type == ceres::NO_CONVERGENCE) {
    solver.callbacks.clear();  // of a damped step the model holds, too
    solver.initial_trust_region_radius = kDampedRadius;
    solver.max_num_iterations *= kDampedIterations;
    ceres::Solve(solver, &problem_, &summary);
    taken += iterations(summary);
  }
  if (!summary.IsSolutionUsable())
    throw std::runtime_error("the factor graph could not be solved: " + summary.message);
  return taken;
}

}  // namespace foucault::fgo
