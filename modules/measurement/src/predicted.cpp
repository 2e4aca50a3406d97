#include "foucault/measurement/predicted.h"

#include <utility>

namespace foucault::measurement {

Predicted::Predicted(std::string_view name, const Values& measured,
                     const Eigen::MatrixXd& covariance, Function predict)
    : name_(name), measured_(measured), covariance_(covariance), predict_(std::move(predict)) {}

state::Linearized Predicted::linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                                       const state::Layout& layout) const {
  constexpr double kMetres = 0.1, kOther = 1e-4;
  const int rows = static_cast<int>(measured_.size());
  state::Linearized z(rows, layout.size());
  z.r = measured_ - predict_(x);
  z.R = covariance_;
  for (int i = 0; i < layout.size(); ++i) {
    const double h = i < state::block::position.size ? kMetres : kOther;
    const state::StateVector step = h * state::StateVector::Unit(layout.size(), i);
    z.H.col(i) = (predict_(state::boxplus(x, step)) - predict_(state::boxplus(x, -step))) / (2 * h);
  }
  return z;
}

ObservationPtr predicted(std::string_view name, const Predicted::Values& measured, double sigma,
                         Predicted::Function predict) {
  const Eigen::VectorXd variances = Eigen::VectorXd::Constant(measured.size(), sigma * sigma);
  return std::make_shared<Predicted>(name, measured, variances.asDiagonal(), std::move(predict));
}

ObservationPtr predicted(std::string_view name, double measured, double sigma,
                         std::function<double(const state::NavState&)> predict) {
  const auto values = [](double value) { return Predicted::Values::Constant(1, value); };
  return predicted(
      name, values(measured), sigma,
      [values, predict = std::move(predict)](const state::NavState& x) -> Predicted::Values {
        return values(predict(x));
      });
}

}  // namespace foucault::measurement
