#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>

#include "course_finder.h"
#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"
#include "initial_state.h"

namespace foucault::alignment {

/// Motion of the antenna over a stretch, estimated from its fixes.
struct MotionFit {
  Eigen::Vector3d begin_velocity_n = Eigen::Vector3d::Zero();  ///< [m/s], at the first fix
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();        ///< [m/s], at the last fix
  Eigen::Vector3d acceleration_n = Eigen::Vector3d::Zero();    ///< mean over the stretch [m/s^2]
  /// Of velocity_n and acceleration_n.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double duration = 0;          ///< [s]
  double fastest_turn = 0;      ///< of the course between fixes [rad/s]
  double innovation_ratio = 0;  ///< mean square of normalized innovations, 1 if all is well
};

/// Kalman filter over the fixes [first, last) with an acceleration that wanders as that of a car
/// does; positions, and velocities where positions are coarse. Axes are taken as independent.
MotionFit fit_motion(std::deque<GnssFix>::const_iterator first,
                     std::deque<GnssFix>::const_iterator last);

/// Alignment while driving, over a straight stretch of 4 to 10 seconds.
class MovingAlignment {
 public:
  MovingAlignment(const CourseLimits& limits, const std::optional<GivenAngle>& given_heading,
                  const Eigen::Quaterniond& q_v_b, const imu::ImuNoise& noise);

  void add(const ImuIncrement& increment);
  std::optional<AlignmentFindings> add(const GnssFix& fix);
  void restart();

  double fastest() const { return fastest_; }  ///< [m/s], for messages

 private:
  std::optional<AlignmentFindings> align(std::deque<GnssFix>::const_iterator first);
  bool straight_and_fast(const MotionFit& fit) const;
  void find_attitude(const MotionFit& fit, AlignmentFindings& findings) const;
  void turn_forces_to_the_end(const Eigen::Vector3d& bias, int64_t begin_ns,
                              AlignmentFindings& findings) const;
  void find_gyro(const MotionFit& fit, int64_t begin_ns, AlignmentFindings& findings) const;
  Eigen::Vector3d bias_estimate(const AlignmentFindings& findings,
                                Eigen::Matrix3d& covariance) const;
  bool credible(const AlignmentFindings& findings) const;

  CourseLimits limits_;
  std::optional<GivenAngle> given_heading_;
  Eigen::Quaterniond q_v_b_;
  imu::ImuNoise noise_;
  std::deque<GnssFix> fixes_;
  std::deque<ImuIncrement> increments_;
  double fastest_ = 0;
};

}  // namespace foucault::alignment
