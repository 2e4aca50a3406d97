#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "foucault/state/interfaces.h"

/// What goes wrong with real recordings, for simulated ones.
namespace foucault::simulation {

enum class FaultKind {
  // Fixes. `size` is in metres unless it says otherwise.
  fix_outliers,     ///< a share `size` of the fixes lies 5 to 50 m off, horizontally
  fix_ramp,         ///< off by an error that grows from 0 to `size` and then is gone, northeast
  fix_jump,         ///< off by `size`, to the east
  fix_gap,          ///< none
  fix_float,        ///< of float quality, every other `size` seconds
  fix_sigma_scale,  ///< sigmas are reported `size` times as large, the errors stay
  fix_sigma_zero,
  fix_sigma_negative,  ///< variances below zero
  fix_sigma_nan,
  fix_duplicate,      ///< each comes twice
  fix_late,           ///< comes `size` seconds after its stamp
  fix_swapped,        ///< each pair in the wrong order
  fix_another_week,   ///< every tenth is stamped `size` weeks later
  fix_stamps_offset,  ///< stamped `size` seconds later
  // Samples of the IMU.
  imu_gap,           ///< nothing
  imu_duplicate,     ///< every tenth comes twice
  imu_backward,      ///< every tenth after its successor
  imu_jitter,        ///< stamps off by noise of sigma `size` [s]
  imu_bursts,        ///< stamped on arrival, `size` at a time, 0.2 ms apart
  imu_nan,           ///< every tenth is not a number
  imu_clipped,       ///< angular rates beyond `size` [rad/s] are cut off
  imu_stuck,         ///< the third gyroscope repeats its last value
  imu_half_rate,     ///< every two samples are one
  imu_interpolated,  ///< on straight lines, from the last sample before to the first after
  imu_splice,  ///< `size` seconds are missing, the stamps after it run on evenly until the end of
               ///< the fault, where they are right again
  imu_gyro_in_degrees,  ///< deg/s where rad/s are said
  imu_accel_in_g,       ///< g where m/s^2 are said
  imu_axes_turned,      ///< half a turn about the forward axis: right is left, down is up
  imu_stamps_offset,    ///< stamped `size` seconds later
};

/// From start_s to start_s + length_s after the first measurement.
struct Fault {
  FaultKind kind;
  double start_s = 0;
  double length_s = std::numeric_limits<double>::infinity();
  double size = 0;
};

/// A recording with faults, of which each sees what the one before has left. Draws come from `seed`
/// alone. The measurements come in the order in which a program that sorts by stamps gives them,
/// except where a fault is one of the order.
/// Memory: the whole recording, 100 bytes a measurement.
class FaultySource : public state::Source {
 public:
  FaultySource(std::unique_ptr<state::Source> source, const std::vector<Fault>& faults,
               int64_t seed);

  std::optional<Measurement> next() override;
  const state::Mounting& mounting() const override { return source_->mounting(); }
  double progress() const override;

 private:
  std::unique_ptr<state::Source> source_;
  std::vector<Measurement> measurements_;
  std::size_t next_ = 0;
};

}  // namespace foucault::simulation
