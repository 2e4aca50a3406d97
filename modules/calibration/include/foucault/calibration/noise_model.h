#pragma once

#include <string_view>
#include <vector>

#include "foucault/imu/imu_noise.h"

namespace foucault::calibration {

/// What is random in a recording. Of what is not the IMU's, factors of what was told with each
/// measurement.
struct NoiseModel {
  imu::ImuNoise imu;
  double fix_white = 1;     ///< of the sigmas of positions
  double fix_coloured = 0;  ///< sigma of their Gauss-Markov part, in the sigmas that were told
  double fix_tau_s = 30;    ///< its correlation time
  double velocity = 1;      ///< of the sigmas of velocities
  double slip = 1;          ///< of the sigma of the velocity to the side that is taken for zero
  double bounce = 1;        ///< of that up and down
  double wheel = 1;         ///< of the sigma of the wheels' speed
};

/// No road is smooth and no wheel round: sigmas of slip and of wheels' speed are at least this,
/// beside what is learned [m/s].
constexpr double kLeastWheelNoise = 0.01;

/// A number of a model that can be learned, by its logarithm.
struct NoiseAxis {
  std::string_view name;  ///< as in learn's output
  std::string_view unit;
  double& (*of)(NoiseModel&);

  double value(NoiseModel model) const { return of(model); }
};

namespace noise_axis {
extern const NoiseAxis accel_white, gyro_white, accel_bias, gyro_bias, fix_white, fix_coloured,
    fix_tau, velocity, slip, bounce, wheel;
}  // namespace noise_axis

}  // namespace foucault::calibration
