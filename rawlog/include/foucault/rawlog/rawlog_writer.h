#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "foucault/core/measurement.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"
#include "foucault/rawlog/recording_notes.h"
#include "foucault/state/interfaces.h"

namespace foucault::rawlog {

class LogWriting;

/// What a rawlog can hold of ours. Event requests are not written.
using Record = std::variant<GnssFix, WheelSpeed, ReferencePose, imu::ImuSample, ImuIncrement>;

int64_t stamp(const Record& record);

/// Stamps of 1950 to 2150: differences between them fit into int64 nanoseconds.
constexpr int64_t kEarliestStamp = -631'152'000 * kNanosecondsPerSecond;
constexpr int64_t kLatestStamp = 5'680'281'600 * kNanosecondsPerSecond;
constexpr bool in_range_of_stamps(int64_t t_ns) {
  return t_ns >= kEarliestStamp && t_ns <= kLatestStamp;
}

enum class WrittenValues {
  finite,  ///< others are refused
  any,     ///< for logs that shall be bad
};

/// Writes an observation-only rawlog, gzip-compressed, in the order of the calls.
///
/// CObservationIMU: rates; an increment becomes its mean rates at its end, so that a reader with
/// `samples: interval_mean` gets the increments back to double rounding (stamps have MRPT's 100 ns
/// resolution; rates are taken over the rounded interval, and a sample at the beginning of the
/// first increment precedes it). GnssFix: NovAtel BESTPOS (ellipsoidal height, undulation 0, sigmas
/// as float, quality as position type) and NMEA GGA (for programs that look for nothing else), with
/// a TopCon PZS beside them when there is a velocity or when covariances are not diagonal.
/// ReferencePose: NovAtel INSPVAS, label REFERENCE (absent velocity or attitude as NaN).
/// WheelSpeed: CObservationOdometry. RecordingNotes: CObservationComment.
///
/// sensorPose: the IMU sits at the vehicle's origin, turned by the mounting; antennas at R_v_b
/// p_b_a; forward-left-up as MRPT has it.
///
/// The file appears under its name in finish(), whole, or not at all: until then it lies beside,
/// and the destructor removes it. Throws DataError if it cannot be written, a value is not finite
/// or a stamp outside the years 1950 to 2150.
class RawlogWriter {
 public:
  explicit RawlogWriter(const std::string& path, const state::Mounting& mounting = {},
                        WrittenValues values = WrittenValues::finite);
  ~RawlogWriter();
  RawlogWriter(RawlogWriter&&) noexcept;

  /// Before everything else.
  void write(const RecordingNotes& notes);
  void write(const imu::ImuSample& sample);
  void write(const ImuIncrement& increment);
  void write(const GnssFix& fix);
  void write(const ReferencePose& pose);
  void write(const WheelSpeed& speed);
  void write(const Record& record);
  /// Event requests are ignored.
  void write(const Measurement& measurement);

  void finish();

 private:
  std::unique_ptr<LogWriting> writing_;
};

}  // namespace foucault::rawlog
