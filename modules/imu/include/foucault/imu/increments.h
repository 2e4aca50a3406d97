#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/imu/imu_noise.h"

namespace foucault::imu {

/// A raw IMU sample in b.
struct ImuSample {
  int64_t t_ns = 0;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< specific force [m/s^2]
};

/// Turns samples into increments.
/// interval_mean: rate * dt, over the interval that ends at the stamp. instantaneous: trapezoid
/// between neighbouring samples. Where samples are missing (more than 1.5 nominal intervals) an
/// increment covers at most one nominal interval and a hole is left; the nominal interval is the
/// running median of the last intervals.
class Incrementer {
 public:
  explicit Incrementer(SampleKind kind);
  /// The increment that `sample` completes; none for the first sample, nor (in a log that begins
  /// with a hole) until the nominal interval is known.
  /// Throws DataError if the stamp does not increase or a value is not finite.
  std::optional<ImuIncrement> add(const ImuSample& sample);

 private:
  void learn_interval(int64_t interval_ns);
  bool interval_known() const;

  SampleKind kind_;
  std::optional<ImuSample> last_;
  std::vector<int64_t> recent_;
  std::size_t next_ = 0;
  int64_t nominal_ns_ = 0;
};

/// Splits an increment at t, its rates taken as constant within. The parts sum up to the whole.
/// Throws std::invalid_argument unless t_begin < t < t_end.
std::pair<ImuIncrement, ImuIncrement> split(const ImuIncrement& increment, int64_t t_ns);

/// The same rates from t on, which is before it begins: over samples that are missing.
ImuIncrement begun_at(const ImuIncrement& increment, int64_t t_ns);

/// Rotation vector of the body over the increment, with the coning term of the previous one.
/// Paper (15). It takes the two as equally long; see previous_increment_scale().
Eigen::Vector3d rotation_with_coning(const Eigen::Vector3d& previous_dtheta,
                                     const Eigen::Vector3d& dtheta);

/// Velocity increment in the body frame at the beginning of the increment: rotation and sculling
/// terms, paper (18), and the next term of the rotation, theta x (theta x dv) / 6: in a long turn
/// at 30 deg/s and 200 Hz 4 um/s^2, 1 cm in 60 s. It takes the two as equally long; see
/// previous_increment_scale().
Eigen::Vector3d velocity_with_sculling(const Eigen::Vector3d& previous_dtheta,
                                       const Eigen::Vector3d& previous_dvel,
                                       const Eigen::Vector3d& dtheta, const Eigen::Vector3d& dvel);

/// Factor by which a previous increment of another length is to be multiplied in the two functions
/// above. With rates linear in time over both intervals, the coning and sculling terms are
/// T^3 / 12 times a product of level and slope, and the cross products of the increments
/// T_p T (T_p + T) / 2 times the same; hence 2 T^2 / (T_p (T_p + T)), which is 1 for equal lengths.
constexpr double previous_increment_scale(double previous_dt, double dt) {
  return 2 * dt * dt / (previous_dt * (previous_dt + dt));
}

}  // namespace foucault::imu
