#pragma once

#include <Eigen/Core>
#include <array>

#include "foucault/imu/imu_noise.h"
#include "foucault/imu/strapdown.h"
#include "foucault/state/layout.h"

/// Error dynamics of the strapdown mechanization: transition and process noise of a NavState's
/// error (state/blocks.h).
/// Sources: Shin (2005), ch. 3; Groves (2013), 14.2.4; here with the attitude error in b.
namespace foucault::ekf {

/// Process noise of the state: of the IMU and its biases, and of the slow blocks.
struct ProcessNoise {
  imu::ImuNoise imu;
  state::Layout layout;
};

/// What the error dynamics need of the motion over one or several increments: integrals in n of
/// which each changes slowly enough, even while the body turns quickly, to stand for the interval.
struct MotionIntegrals {
  double dt = 0;                                                  ///< [s]
  Eigen::Vector3d specific_velocity_n = Eigen::Vector3d::Zero();  ///< of C f [m/s]
  Eigen::Matrix3d attitude = Eigen::Matrix3d::Zero();             ///< of C = R_n_b [s]
  /// Of C M omega_ib_b [rad] and of C M f_b [m/s] by the elements of M, state::ImuScale.
  Eigen::Matrix3d by_gyro_scale = Eigen::Matrix3d::Zero();
  std::array<Eigen::Matrix3d, 2> by_gyro_cross{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};
  Eigen::Matrix3d by_accel_scale = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d by_accel_cross = Eigen::Matrix3d::Zero();
  double gyro_variance = 0;   ///< of white noise power [rad^2]
  double accel_variance = 0;  ///< [m^2/s^2]

  /// Adds a compensated increment over which R_n_b changes as given.
  void add(const ImuIncrement& increment, const Eigen::Matrix3d& R_n_b_begin,
           const Eigen::Matrix3d& R_n_b_end, const imu::ImuNoise& noise);
};

/// A transition of errors. The rows of position, velocity and attitude are full; those of what
/// drives them below hold nothing but its decay on the diagonal.
struct Phi {
  state::MotionByState motion;
  state::StateVector decay;

  static Phi identity(Eigen::Index size);  ///< size: rows of the state
  state::StateMatrix full() const;
};
Phi operator*(const Phi& later, const Phi& earlier);

/// error(end) = phi * error(begin) + w, var w = q.
struct Transition {
  Phi phi;
  state::StateMatrix q;
};

/// Transition over the integrals' interval, from `begin` to `end`. Series to the third order in dt
/// of the mean dynamics; biases and slow blocks as Gauss-Markov processes in closed form;
/// q by Simpson's rule, exact for white noise integrated into velocity and position.
Transition transition(const MotionIntegrals& integrals, const state::NavState& begin,
                      const state::NavState& end, const ProcessNoise& noise);

/// phi P phi' + q.
state::StateMatrix propagated(const state::StateMatrix& covariance, const Transition& transition);

}  // namespace foucault::ekf
