#pragma once

#include <functional>
#include <string_view>

#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// A measurement by its prediction alone: derivatives are taken by differences, over 0.1 m of the
/// position and 1e-4 of the unit of all else, by two predictions a row of the state. For what is
/// measured a few times a second, as a class of its own is not worth the algebra.
class Predicted final : public Observation {
 public:
  using Values = decltype(state::Linearized::r);  ///< up to six
  using Function = std::function<Values(const state::NavState&)>;

  /// name: see Observation::name(); covariance: of what was measured.
  Predicted(std::string_view name, const Values& measured, const Eigen::MatrixXd& covariance,
            Function predict);

  std::string_view name() const override { return name_; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override;

 private:
  std::string_view name_;
  Values measured_;
  Eigen::MatrixXd covariance_;
  Function predict_;
};

/// The same of values with one sigma, whose errors have nothing to do with each other.
ObservationPtr predicted(std::string_view name, const Predicted::Values& measured, double sigma,
                         Predicted::Function predict);
/// Of one value.
ObservationPtr predicted(std::string_view name, double measured, double sigma,
                         std::function<double(const state::NavState&)> predict);

}  // namespace foucault::measurement
