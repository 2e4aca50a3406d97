#pragma once

#include <cmath>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/state/nav_state.h"

/// Random states, errors and covariances for tests.
namespace foucault::testing {

/// Independent normal numbers.
inline state::StateVector draw(std::mt19937& rng, Eigen::Index size) {
  std::normal_distribution<double> normal;
  state::StateVector v(size);
  for (double& value : v) value = normal(rng);
  return v;
}

inline Eigen::Vector3d draw3(std::mt19937& rng) { return draw(rng, 3); }

inline double between(std::mt19937& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

/// Latitudes to +-80 deg, any longitude and attitude, speeds to 250 m/s.
inline state::NavState random_state(std::mt19937& rng, Eigen::Index slow_size) {
  state::NavState x;
  x.position = {between(rng, -80, 80) * kDegree, between(rng, -kPi, kPi), between(rng, -100, 12e3)};
  x.velocity_n = between(rng, 0, 250) * draw3(rng).normalized();
  x.q_n_b = Eigen::Quaterniond(Eigen::Vector4d(draw(rng, 4))).normalized();
  x.bias = {1e-2 * draw3(rng), 0.1 * draw3(rng)};
  x.slow = draw(rng, slow_size);
  return x;
}

/// Positive definite, full of correlations, about 1 on the diagonal; its condition is below 100.
inline state::StateMatrix random_covariance(std::mt19937& rng, Eigen::Index size) {
  state::StateMatrix root(size, size);
  for (Eigen::Index i = 0; i < size; ++i) root.col(i) = draw(rng, size);
  return root * root.transpose() / static_cast<double>(size) +
         0.1 * state::StateMatrix::Identity(size, size);
}

}  // namespace foucault::testing
