#pragma once

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <memory>

#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/gnss_factor.h"

/// How the window and the batch use Ceres.
namespace foucault {

/// Null for plain least squares.
std::unique_ptr<ceres::LossFunction> make_loss(const FgoOptions& options);

/// rho'(s): a robust loss as a weight on the squared residual at the solution; 1 without a loss.
double loss_weight(const ceres::LossFunction* loss, const GnssFactor::Linearized& fix);

/// Nothing is owned by the problem.
ceres::Problem::Options problem_options();

/// Solves from the values that the parameter blocks have.
/// Throws std::runtime_error if that fails.
void optimize(ceres::Problem& problem, const FgoOptions& options);

}  // namespace foucault
