#include "foucault/simulation/spline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace foucault::simulation {
namespace {

using Weights = Eigen::Matrix<double, QuinticSpline::kControls, 1>;
using Basis = Eigen::Matrix<double, QuinticSpline::kControls, QuinticSpline::kControls>;

/// Row j: the weight of control point j as a polynomial in u, ascending powers.
Basis basis_matrix() {
  Basis m;
  m << 1, -5, 10, -10, 5, -1,    //
      26, -50, 20, 20, -20, 5,   //
      66, 0, -60, 0, 30, -10,    //
      26, 50, 20, -20, -20, 10,  //
      1, 5, 10, 10, 5, -5,       //
      0, 0, 0, 0, 0, 1;
  return m / 120.0;
}

}  // namespace

QuinticSpline::QuinticSpline(double knot_interval, std::vector<Eigen::Vector3d> controls)
    : knot_interval_(knot_interval), controls_(std::move(controls)) {
  if (!(knot_interval_ > 0)) throw std::invalid_argument("spline: knot interval must be positive");
  if (controls_.size() < kControls)
    throw std::invalid_argument("spline: six control points needed");
}

std::size_t QuinticSpline::controls_for(double duration, double knot_interval) {
  const double intervals = std::max(1.0, std::ceil(duration / knot_interval));
  return static_cast<std::size_t>(intervals) + kControls - 1;
}

QuinticSpline::Sample QuinticSpline::at(double t) const {
  static const Basis kBasis = basis_matrix();
  const double x = t / knot_interval_;
  const double last = static_cast<double>(intervals() - 1);
  const double first = std::clamp(std::floor(x), 0.0, last);
  const double u = x - first;
  const double u2 = u * u, u3 = u2 * u, u4 = u2 * u2;
  const double h = knot_interval_;

  Weights powers, first_derivative, second_derivative;
  powers << 1, u, u2, u3, u4, u4 * u;
  first_derivative << 0, 1, 2 * u, 3 * u2, 4 * u3, 5 * u4;
  second_derivative << 0, 0, 2, 6 * u, 12 * u2, 20 * u3;
  const Weights value_weights = kBasis * powers;
  const Weights rate_weights = kBasis * first_derivative / h;
  const Weights acceleration_weights = kBasis * second_derivative / (h * h);

  // The weights sum to one (value) and zero (derivatives): differences to one control point keep
  // the precision of the motion, however far from the origin it is.
  const Eigen::Vector3d* const control = &controls_[static_cast<std::size_t>(first)];
  const Eigen::Vector3d& centre = control[kControlsBefore];
  Sample sample{centre, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int j = 0; j < kControls; ++j) {
    const Eigen::Vector3d offset = control[j] - centre;
    sample.value += value_weights[j] * offset;
    sample.rate += rate_weights[j] * offset;
    sample.acceleration += acceleration_weights[j] * offset;
  }
  return sample;
}

}  // namespace foucault::simulation
