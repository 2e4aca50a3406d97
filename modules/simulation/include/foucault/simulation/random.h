#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>

#include "foucault/core/constants.h"

namespace foucault::simulation {

/// What a stream of random numbers is for. Each has a generator of its own, so that switching one
/// error on or off leaves the draws of the others as they are.
enum class RandomStream : uint32_t {
  motion = 1,
  surface,
  heading,
  gyro_white,
  accel_white,
  gyro_turn_on,
  accel_turn_on,
  gyro_bias,
  accel_bias,
  scale_factor,
  gnss_position,
  gnss_velocity,
  faults,
  start,
  cross_axis,
  rectification,
  gnss_coloured,
  wheel,
  slip,
  gnss_heading
};

/// Reproducible draws: the same seed and stream give the same numbers.
class Draws {
 public:
  Draws(int64_t seed, RandomStream stream);

  double normal() { return normal_(engine_); }  ///< mean 0, sigma 1
  Eigen::Vector3d normal3();                    ///< three of them
  double uniform(double low, double high);      ///< in [low, high)
  double phase() { return uniform(0, 2 * kPi); }
  bool happens(double probability) { return uniform(0, 1) < probability; }
  double sign() { return happens(0.5) ? 1.0 : -1.0; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// A first-order Gauss-Markov process of sigma 1 after `elapsed` time constants, discretized
/// exactly; `draw` is normal. T: a number or an Eigen vector.
template <class T>
T next_markov(const T& value, double elapsed, const T& draw) {
  return T(std::exp(-elapsed) * value + std::sqrt(-std::expm1(-2 * elapsed)) * draw);
}

}  // namespace foucault::simulation
