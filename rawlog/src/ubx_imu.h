#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "ubx_file.h"

/// Samples of a u-blox receiver's own IMU (class ESF) on the receiver's clock.
/// Source: u-blox ZED-F9R and M8 descriptions ("sensor data types"); that the first word of ESF-RAW
/// is the clock of its first sample, and that tags have 24 bits of 39.0625 us each, is seen in
/// recordings of M8L and M8U, whose sensor counts 0.3 % faster.
namespace foucault::rawlog {

struct UbxImuSample {
  int64_t boot_us = 0;  ///< clock since power-up; of ESF-MEAS the middle of its mean
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< specific force [m/s^2]
};

constexpr uint16_t kUbxEsfMeas = 0x1002;
constexpr uint16_t kUbxEsfRaw = 0x1003;

/// Six values until all are there.
class UbxAxes {
 public:
  /// One of ESF's words: data in 24 bits, type above. False if it is none of the six.
  bool take(uint32_t word);
  bool has_gyro() const { return (seen_ & kGyro) == kGyro; }
  bool has_accel() const { return (seen_ & kAccel) == kAccel; }
  bool complete() const { return has_gyro() && has_accel(); }
  void clear() { seen_ = 0; }
  Eigen::Vector3d gyro() const { return gyro_; }
  Eigen::Vector3d accel() const { return accel_; }

 private:
  static constexpr unsigned kGyro = 7;
  static constexpr unsigned kAccel = 7U << 3U;

  unsigned seen_ = 0;
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_ = Eigen::Vector3d::Zero();
};

/// The sensor's count of ESF-RAW on the receiver's clock.
class UbxTags {
 public:
  /// Ticks and clock over a whole recording, to see how long a tick is.
  void survey(uint32_t clock_ms, uint32_t tag);
  /// Begins again, with the length of the tick that was seen.
  void restart();

  void begin_message(uint32_t clock_ms, uint32_t tag);
  /// Of a tag of the message that was begun [us].
  int64_t boot_us(uint32_t tag);

 private:
  int64_t unrolled(uint32_t tag);

  std::optional<uint32_t> last_tag_;
  int64_t ticks_ = 0;
  int64_t first_ms_ = 0, first_ticks_ = 0, last_ms_ = 0;
  double tick_us_ = 39.0625;
  std::optional<double> offset_us_;  ///< clock minus ticks, smoothed: the clock has whole ms only
};

/// Samples of one kind of messages.
class UbxImuSamples {
 public:
  /// `key`: kUbxEsfRaw or kUbxEsfMeas.
  explicit UbxImuSamples(uint16_t key) : key_(key) {}

  void survey(const UbxMessage& message);
  void restart() { tags_.restart(); }
  /// Throws RecordTooShort.
  void take(const UbxMessage& message);
  /// The next sample of what was taken.
  std::optional<UbxImuSample> next();

 private:
  void take_raw(const UbxMessage& message);
  void take_meas(const UbxMessage& message);
  uint16_t key_;
  UbxTags tags_;
  UbxAxes axes_;
  int64_t gyro_us_ = 0, accel_us_ = 0;
  std::deque<UbxImuSample> ready_;
};

}  // namespace foucault::rawlog
