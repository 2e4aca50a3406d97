#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/result.h"

namespace foucault::alignment {

/// What an alignment has found out, at one stamp, with the errors of each piece. Independent errors
/// are listed; how they spread over the state is worked out by initial_state().
struct AlignmentFindings {
  GnssFix fix;  ///< position of the antenna, lever arm
  Eigen::Quaterniond q_v_b = Eigen::Quaterniond::Identity();

  Eigen::Vector3d antenna_velocity_n = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d acceleration_n = Eigen::Vector3d::Zero();      ///< mean over the level [m/s^2]
  /// Joint covariance of antenna_velocity_n and acceleration_n.
  Eigen::Matrix<double, 6, 6> motion_covariance = Eigen::Matrix<double, 6, 6>::Zero();

  Eigen::Vector3d specific_force_b = Eigen::Vector3d::Zero();  ///< mean, turned to the stamp
  Eigen::Matrix3d specific_force_covariance = Eigen::Matrix3d::Zero();  ///< noise, not bias

  double heading = 0;           ///< of the vehicle [rad]
  double heading_variance = 0;  ///< [rad^2], independent of all else

  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();  ///< mean rate measured [rad/s]
  Eigen::Vector3d turn_n = Eigen::Vector3d::Zero();  ///< true mean rate of b against n [rad/s]
  Eigen::Matrix3d gyro_covariance = Eigen::Matrix3d::Zero();  ///< of both together, b
  Eigen::Vector3d omega_b = Eigen::Vector3d::Zero();  ///< true rate at the stamp, for the lever arm
};

/// Reaction to gravity and acceleration that an ideal accelerometer feels, in n [m/s^2].
Eigen::Vector3d specific_force_n(const AlignmentFindings& findings);

/// The attitude of `findings`: R f_b = a_n - g_n in direction, forward axis at the heading.
Eigen::Quaterniond attitude_of(const AlignmentFindings& findings);

/// Sets stamp, position and velocity of an epoch whose attitude is known, from those of the
/// antenna.
void place_at_imu(state::Epoch& epoch, const GnssFix& fix,
                  const Eigen::Vector3d& antenna_velocity_n, const Eigen::Vector3d& omega_b);

/// State and covariance.
///   level: f x dtheta = -(b_a + n + R^T da) across f, so dtheta = f x (...) / |f|^2
///   heading: rotation about f that puts the forward axis right
///   gyro bias: gyro_b - R^T (omega_ie + turn), so db = -[w_b x] dtheta - n
///   position, velocity: lever arm turned by dtheta
/// and then the priors of the biases; the length of f tells the accelerometer's bias along it.
/// Scale factors of the accelerometers, if `layout` has them, share in level and length of f: what
/// the length tells is bias and scale together.
state::Epoch initial_state(const AlignmentFindings& findings, const imu::ImuNoise& noise,
                           const state::Layout& layout = {});

/// A given angle in the place of the one found.
struct GivenAngle {
  double value = 0;  ///< [rad]
  double sigma = 0;  ///< [rad]
};
struct GivenAngles {
  std::optional<GivenAngle> roll, pitch, heading;
};

/// Replaces the angles of the vehicle by given ones; their errors are independent of all else.
state::Epoch with_given_angles(const state::Epoch& epoch, const Eigen::Quaterniond& q_v_b,
                               const GivenAngles& given);

/// The findings with the heading of two antennas that the fix has, whose direction in the vehicle
/// is taken as told. Precondition: it has one.
AlignmentFindings with_antenna_heading(const AlignmentFindings& findings);

/// The state from these shares what is not known of that direction: d(heading) has -d(direction)
/// beside the error of the measurement. As it is where the layout has no baseline_heading.
state::Epoch with_baseline_block(const state::Epoch& epoch, const AlignmentFindings& findings,
                                 const state::Layout& layout);

/// State from three given angles; biases zero with their priors.
/// velocity_covariance [m^2/s^2].
state::Epoch given_state(const GnssFix& fix, const Eigen::Vector3d& antenna_velocity_n,
                         const Eigen::Matrix3d& velocity_covariance, const Eigen::Vector3d& omega_b,
                         const Eigen::Quaterniond& q_v_b, const GivenAngles& given,
                         const imu::ImuNoise& noise);

/// An epoch whose position was made of a fix shares what is not known of the antenna and of its
/// clock: position = fix - C l + v s, so that d(position) has -C dl + v ds beside the error of the
/// fix. Without this the height of the first fix would tell the vertical lever arm. What the offset
/// does to a velocity, acceleration times ds, is left out.
state::Epoch with_antenna_blocks(const state::Epoch& epoch, const state::Layout& layout);

}  // namespace foucault::alignment
