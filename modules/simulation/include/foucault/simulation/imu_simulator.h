#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/imu/increments.h"
#include "foucault/simulation/random.h"
#include "foucault/simulation/trajectory.h"
#include "foucault/state/blocks.h"

namespace foucault::simulation {

/// What a perfect IMU of axes b gives over (t_begin, t_end]:
///   dtheta_b = integral of omega_ib_b dt [rad], dvel_b = integral of f_b dt [m/s],
/// both in the turning frame b, as the interval means of real sensors are. Gauss-Legendre with
/// four nodes on pieces of at most 10 ms: exact to rounding on a Trajectory.
/// Stamps count from start_ns, where the trajectory's t = 0 is.
ImuIncrement exact_increment(const Trajectory& trajectory, const Eigen::Quaterniond& q_v_b,
                             int64_t start_ns, int64_t t_begin_ns, int64_t t_end_ns);

/// The rates of a sample with `interval_mean` meaning: increment / dt, stamp at the end.
imu::ImuSample interval_mean_sample(const ImuIncrement& increment);

/// Errors of an IMU on top of exact increments: measured = (1 + scale) * exact + bias * dt + noise.
/// The bias is a constant turn-on value plus a first-order Gauss-Markov process in its steady
/// state, discretized exactly: b(t + dt) = e^(-dt/tau) b(t) + w, var w = sigma^2 (1 -
/// e^(-2dt/tau)); within an increment it is taken as the mean of its ends. Every error has its own
/// generator.
class ImuErrors {
 public:
  /// scale_sigma: of each axis, a pure number.
  ImuErrors(const imu::ImuNoise& noise, double scale_sigma, int64_t seed);

  /// Increments must come without holes, also those that are not given out.
  ImuIncrement apply(const ImuIncrement& exact);

  /// True bias at the end of the last increment, the scale factor not included.
  state::ImuBias bias() const;

 private:
  /// One triad of sensors.
  struct Triad {
    Triad(double noise_density, double bias_sigma, double turn_on_sigma, double scale_sigma,
          Draws white_draws, Draws bias_draws, Draws turn_on_draws, Draws& scale_draws);
    Eigen::Vector3d apply(const Eigen::Vector3d& exact, double dt, double tau);
    Eigen::Vector3d bias() const { return turn_on + wander; }

    double noise_density, bias_sigma;
    Draws white_draws, bias_draws;
    Eigen::Vector3d turn_on;
    Eigen::Vector3d scale;
    Eigen::Vector3d wander;  ///< Gauss-Markov part of the bias
  };

  double tau_;
  Draws scale_draws_;
  Triad gyro_, accel_;
};

}  // namespace foucault::simulation
