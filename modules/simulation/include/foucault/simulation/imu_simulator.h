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

/// What an IMU has beside noise and biases. Sigmas are pure numbers.
struct ImuFlaws {
  double scale_sigma = 0;  ///< of each axis
  /// Of what an axis feels of another: all six of the gyroscopes, three of the accelerometers (x of
  /// y and z, y of z). The other three would turn both triads alike, which is a mounting.
  double cross_axis_sigma = 0;
  /// Accelerometer bias of each axis at 15 m/s [m/s^2], its sign by the seed: rectified vibration.
  double rectification = 0;
};

/// Errors of an IMU on top of exact increments: measured = M * exact + bias * dt + noise, M the
/// identity plus scale factors and cross-axis terms.
/// The bias is a constant turn-on value plus a first-order Gauss-Markov process in its steady
/// state, discretized exactly: b(t + dt) = e^(-dt/tau) b(t) + w, var w = sigma^2 (1 -
/// e^(-2dt/tau)), and, of the accelerometers, +-rectification * (speed / 15 m/s)^2; within an
/// increment it is taken as the mean of its ends. Every error has its own generator.
class ImuErrors {
 public:
  ImuErrors(const imu::ImuNoise& noise, const ImuFlaws& flaws, int64_t seed);

  /// Increments must come without holes, also those that are not given out. speed: of the vehicle
  /// at the increment's end [m/s].
  ImuIncrement apply(const ImuIncrement& exact, double speed = 0);

  /// True bias at the end of the last increment, M not included.
  state::ImuBias bias() const;

 private:
  /// One triad of sensors.
  struct Triad {
    Triad(double noise_density, double bias_sigma, double turn_on_sigma, double scale_sigma,
          Draws white_draws, Draws bias_draws, Draws turn_on_draws, Draws& scale_draws);
    Eigen::Vector3d apply(const Eigen::Vector3d& exact, double dt, double tau,
                          const Eigen::Vector3d& rectified_at_end);
    Eigen::Vector3d bias() const { return turn_on + wander + rectified; }

    double noise_density, bias_sigma;
    Draws white_draws, bias_draws;
    Eigen::Vector3d turn_on;
    Eigen::Vector3d scale;
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  ///< off the diagonal
    Eigen::Vector3d wander;                           ///< Gauss-Markov part of the bias
    Eigen::Vector3d rectified = Eigen::Vector3d::Zero();
  };

  double tau_;
  Draws scale_draws_;
  Triad gyro_, accel_;
  Eigen::Vector3d rectification_;  ///< of the accelerometers at 15 m/s [m/s^2]
};

}  // namespace foucault::simulation
