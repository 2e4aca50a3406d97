#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <optional>

#include "foucault/measurement/body_stretch.h"
#include "foucault/state/epoch.h"

namespace foucault::diagnosis {

/// What a vehicle whose state fixes hold does beside rolling forward.
struct SlipFindings {
  int samples = 0;  ///< stretches in motion behind it
  Eigen::Vector2d mounting =
      Eigen::Vector2d::Zero();                      ///< pitch, heading, as state::block::mounting
  Eigen::Vector3d arm_b = Eigen::Vector3d::Zero();  ///< IMU to the point that slips least [m]
  /// Velocity of that point to the right and downward: deviation beyond what the state's covariance
  /// explains, and that of white noise of as much power, which is larger where it lasts [m/s].
  Eigen::Vector2d deviation = Eigen::Vector2d::Zero();
  Eigen::Vector2d white = Eigen::Vector2d::Zero();
  double speed = 0;  ///< root mean square of the velocity [m/s]
};

/// Of the wheels.
struct WheelFindings {
  int samples = 0;
  double scale = 0;                 ///< forward velocity = (1 + scale) times the wheels'
  double deviation = 0, white = 0;  ///< as above [m/s]
};

/// Looks whether wheels roll without slip: velocities of the body where fixes hold the state,
/// fitted by a mounting and a point of the vehicle. Robust (Huber); nothing of it enters the state.
class SlipWatch {
 public:
  explicit SlipWatch(const Eigen::Quaterniond& q_v_b) : C_v_b_(q_v_b.toRotationMatrix()) {}

  /// A stretch at whose end the state is held by fixes. wheel: mean speed that was told over it.
  void add(const measurement::BodyStretch& stretch, const state::Epoch& epoch,
           const std::optional<double>& wheel);

  /// None of fewer than thirty stretches in motion.
  const std::optional<SlipFindings>& slip() const { return slip_; }
  const std::optional<WheelFindings>& wheel() const { return wheel_; }

 private:
  struct Sample {
    Eigen::Vector3d velocity_v;    ///< of the IMU on the told axes [m/s]
    Eigen::Vector3d rate_v;        ///< [rad/s]
    Eigen::Matrix3d covariance_v;  ///< of the velocity, of the state alone
    std::optional<double> wheel;
  };
  using Fit = Eigen::Matrix<double, 5, 1>;  ///< pitch, heading, arm on the told axes

  Eigen::Vector3d point_velocity(const Sample& sample, const Fit& fit) const;
  void fit();
  void step();
  void judge_slip();
  void judge_wheel();

  Eigen::Matrix3d C_v_b_;
  std::deque<Sample> samples_;
  int since_fit_ = 0;
  Fit fit_ = Fit::Zero();
  Eigen::Vector2d spread_ = Eigen::Vector2d::Constant(0.1);  ///< deviations that the fit weighs by
  std::optional<SlipFindings> slip_;
  std::optional<WheelFindings> wheel_;
};

}  // namespace foucault::diagnosis
