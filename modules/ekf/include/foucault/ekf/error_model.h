#pragma once

#include <Eigen/Core>

#include "foucault/state/blocks.h"
#include "foucault/inertial/imu_noise.h"
#include "foucault/inertial/strapdown.h"

/// Error dynamics of the strapdown mechanization: error state, transition, process noise.
/// The error is true minus estimated, in the order of error_state, [dp dv dtheta dbg dba], and
/// with scale factors [... dsg dsa]. dp is metres north, east, down of the place, dv the difference
/// of the NED components, dtheta a right perturbation in b.
/// Sources: Shin (2005), ch. 3; Groves (2013), 14.2.4; here with the attitude error in b.
namespace foucault::ekf {

constexpr int kGyroScale = error_state::kSize;  ///< dsg, a pure number
constexpr int kAccelScale = kGyroScale + 3;     ///< dsa
constexpr int kSizeWithScale = kAccelScale + 3;

/// 15 or 21 rows, on the stack.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                             kSizeWithScale, kSizeWithScale>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kSizeWithScale, 1>;

/// What the filter estimates. measured = (1 + scale) * true + bias.
struct FullState {
  StrapdownState motion;
  ImuBias bias;
  Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_scale = Eigen::Vector3d::Zero();
};

/// The state with an error put right; 15 or 21 rows.
FullState corrected(const FullState& state, const Vector& error);

/// The error of which `to` is the corrected `from`: corrected(from, difference(from, to, n)) == to.
/// The position is measured with the radii of `from`.
Vector difference(const FullState& from, const FullState& to, int size);

/// The increment that error-free sensors would have given, as far as the state knows.
ImuIncrement compensated(const ImuIncrement& increment, const FullState& state);

/// Process noise of the state, Gauss-Markov processes included.
struct ProcessNoise {
  ImuNoise imu;
  bool with_scale = false;
  double gyro_scale_sigma = 0;  ///< steady state
  double accel_scale_sigma = 0;
  double scale_tau = 3600;  ///< [s]

  int size() const { return with_scale ? kSizeWithScale : error_state::kSize; }
};

/// What the error dynamics need of the motion over one or several increments: integrals in n of
/// which each changes slowly enough, even while the body turns quickly, to stand for the interval.
struct MotionIntegrals {
  double dt = 0;                                                  ///< [s]
  Eigen::Vector3d specific_velocity_n = Eigen::Vector3d::Zero();  ///< of C f [m/s]
  Eigen::Matrix3d attitude = Eigen::Matrix3d::Zero();             ///< of C = R_n_b [s]
  Eigen::Matrix3d attitude_rate = Eigen::Matrix3d::Zero();        ///< of C diag(omega_ib_b) [rad]
  Eigen::Matrix3d attitude_force = Eigen::Matrix3d::Zero();       ///< of C diag(f_b) [m/s]
  double gyro_variance = 0;                                       ///< of white noise power [rad^2]
  double accel_variance = 0;                                      ///< [m^2/s^2]

  /// Adds a compensated increment over which R_n_b changes as given.
  void add(const ImuIncrement& increment, const Eigen::Matrix3d& R_n_b_begin,
           const Eigen::Matrix3d& R_n_b_end, const ImuNoise& noise);
};

/// error(end) = phi * error(begin) + w, var w = q.
struct Transition {
  Matrix phi;
  Matrix q;
};

/// Transition over the integrals' interval, from `begin` to `end`. Series to the third order in dt
/// of the mean dynamics; biases and scale factors as Gauss-Markov processes in closed form;
/// q by Simpson's rule, exact for white noise integrated into velocity and position.
Transition transition(const MotionIntegrals& integrals, const StrapdownState& begin,
                      const StrapdownState& end, const ProcessNoise& noise);

/// phi P phi' + q, by the rows of the motion and the diagonal that the rest of phi is.
Matrix propagated(const Matrix& covariance, const Transition& transition);

}  // namespace foucault::ekf
