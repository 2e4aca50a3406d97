#pragma once

#include <ceres/loss_function.h>

#include <memory>

#include "foucault/fgo/fgo_options.h"
#include "foucault/fgo/whitened_rows.h"

namespace foucault::fgo {

/// Null for plain least squares.
std::unique_ptr<ceres::LossFunction> make_loss(const FgoOptions& options);

/// rho(s) and rho'(s) of a squared residual: what it costs, and as a weight on it. Without a loss
/// they are s and 1.
struct RobustCost {
  double cost;
  double weight;
};
RobustCost robust_cost(const ceres::LossFunction* loss, const ObservationRows& z);

}  // namespace foucault::fgo
