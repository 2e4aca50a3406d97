#include "robust_loss.h"

namespace foucault::fgo {

std::unique_ptr<ceres::LossFunction> make_loss(const FgoOptions& options) {
  if (options.robust == "huber") return std::make_unique<ceres::HuberLoss>(options.robust_scale);
  if (options.robust == "cauchy") return std::make_unique<ceres::CauchyLoss>(options.robust_scale);
  return nullptr;
}

RobustCost robust_cost(const ceres::LossFunction* loss, const ObservationRows& z) {
  const double s = z.r.squaredNorm();
  if (loss == nullptr) return {s, 1};
  double rho[3];
  loss->Evaluate(s, rho);
  return {rho[0], rho[1]};
}

}  // namespace foucault::fgo
