#pragma once

#include "foucault/measurement/observation.h"

namespace foucault::measurement {

/// The antenna at a state: where it is from the IMU, how it moves, and what of that depends on
/// what. l = l_fix + dl, omega = (rate - bias) / (1 + scale) by axis, v_a = v + C (omega x l), a_a
/// = C (force - bias) + g; what turns in a_a (omega x (omega x l), angular acceleration), the
/// rotation of n and of the Earth are left out: 0.1 mm/s, and of a fix 0.1 s late 5 mm at a metre
/// of arm and 1 rad/s. The offset is that of the time since the first fix.
struct Antenna {
  Antenna(const state::NavState& x, const MeanMotion& mean, const state::Layout& layout,
          const Eigen::Vector3d& p_b_a, double since_first);

  bool has_time() const { return time_offset || time_drift; }

  /// d(C (omega x l)) by the blocks, times `factor`, added to H.
  void add_swing(double factor, state::Linearized& z) const;

  /// d(omega) by the blocks, times `factor`, added to H.
  void add_rate(const Eigen::Matrix3d& factor, state::Linearized& z) const;

  /// d(offset) by the blocks, times `by_offset`, into H.
  void put_time(const Eigen::Vector3d& by_offset, state::Linearized& z) const;

  /// d(a_a) by the blocks, times `factor`, added to H.
  void add_acceleration(double factor, state::Linearized& z) const;

  Eigen::Matrix3d C;                                         ///< b to n
  Eigen::Vector3d l_b;                                       ///< [m]
  Eigen::Vector3d omega_b;                                   ///< [rad/s]
  Eigen::Vector3d swing_b;                                   ///< omega x l [m/s]
  Eigen::Vector3d velocity_n;                                ///< v_a
  Eigen::Vector3d acceleration_n = Eigen::Vector3d::Zero();  ///< a_a; zero if unknown
  double offset = 0;                                         ///< of time; zero if not estimated [s]
  const state::SlowBlock* lever_arm;
  const state::SlowBlock* time_offset;
  const state::SlowBlock* time_drift;
  const state::SlowBlock* gyro_scale;
  const state::SlowBlock* accel_scale;

 private:
  double since_first_;                                 ///< [s]
  Eigen::Vector3d by_scale_;                           ///< 1 / (1 + scale), of the gyroscopes
  Eigen::Vector3d by_accel_scale_;                     ///< the same of the accelerometers
  Eigen::Vector3d force_b_ = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

}  // namespace foucault::measurement
