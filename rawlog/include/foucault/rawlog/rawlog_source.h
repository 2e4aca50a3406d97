#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"

namespace foucault::rawlog {

class LogReading;

/// Section `rawlog` of the configuration: what is taken from a log with several sensors.
class RawlogOptions : public Configurable {
 public:
  std::string imu_label;                      ///< sensorLabel of the IMU; empty: the first one
  std::string gnss_label;                     ///< of the receiver; empty: the first with a position
  std::string reference_label = "REFERENCE";  ///< of the reference trajectory
  double reorder_s = 2.0;                     ///< records may come this late [s]
  double fix_delay_s = 0;  ///< fixes are of so much before their stamps [s]; no key of its own

  void fields(ConfigFields& f) override;
};

/// What a source has read so far.
struct SourceCounts {
  int64_t imu_samples = 0;
  int64_t fixes = 0;
  int64_t references = 0;
  int64_t wheel_speeds = 0;
  int64_t imu_duplicates = 0;  ///< samples equal to their predecessor, stamp included; dropped
  int64_t imu_reordered = 0;   ///< samples that came after later ones; put in order
  int64_t late = 0;            ///< came more than reorder_s after their stamp; dropped
  std::map<std::string, int64_t> skipped;  ///< everything else, by class (and reason)
};

/// Streams an MRPT rawlog (gzip or plain; sensory frames or observations only) as measurements.
///
/// Frames: b are the IMU's axes as recorded; v is forward-right-down (MRPT's forward-left-up turned
/// half a turn about x, once, here). sensorPose of the first IMU gives the mounting q_v_b; lever
/// arms are p_b_a = R_b_v (p_v_a - p_v_b). Heights are ellipsoidal.
///
/// CObservationIMU -> ImuIncrement. CObservationGPS -> GnssFix, from NovAtel BESTPOS (sigmas),
/// TopCon PZS (covariance; also the velocity beside BESTPOS), else NMEA GGA (altitude + geoid
/// separation; sigma assumed by fix quality and HDOP) with RMC or VTG, which may come in records of
/// their own, else RMC alone (no height). Covariance and fix type of newer records (MRPT >=
/// 2.11.12) count more. Rates and forces in records of their own are joined. Label REFERENCE:
/// NovAtel INSPVAS -> ReferencePose of the IMU centre (NaN attitude or velocity: absent);
/// CObservationRobotPose -> the same, its frame being East-North-Up at the first fix.
/// CObservationOdometry with velocities -> WheelSpeed. The rest is skipped and counted by class.
///
/// Order: by stamp, as core/measurement.h says. IMU samples and fixes may come up to reorder_s
/// late. An IMU stamp more than a second ahead of the one before it counts if the next confirms it.
/// Stamps of samples that a host stamped on arrival in bursts are made even (BurstStamps), which
/// needs reorder_s to look ahead.
/// Memory: constant; it grows only with what lies within reorder_s, or ahead of the IMU.
///
/// Values that are not finite are skipped and counted, and so are IMU samples that come later than
/// reorder_s or repeat a stamp.
/// Damage in the log (truncated, corrupt, records of a newer MRPT) ends it: everything before comes
/// out, then next() gives none and damage() says what and where.
///
/// Throws DataError, one line naming the file, for: missing, a directory, empty, not a rawlog, no
/// IMU, no GNSS, damage before the first of either, more than 100 IMU samples in a row that come
/// too late (record number and stamp), IMU and GNSS that do not overlap in time or fixes that are
/// all late (when the log ends).
class RawlogSource : public state::Source {
 public:
  explicit RawlogSource(const std::string& path,
                        imu::SampleKind samples = imu::SampleKind::interval_mean,
                        const RawlogOptions& options = {});
  ~RawlogSource() override;
  RawlogSource(RawlogSource&&) noexcept;

  std::optional<Measurement> next() override;
  const state::Mounting& mounting() const override;
  double progress() const override;

  /// IMU to antenna in b [m], of the first fix.
  const Eigen::Vector3d& lever_arm() const;
  const std::string& imu_label() const;
  const std::string& gnss_label() const;
  const SourceCounts& counts() const;
  /// What was left out, one notice a kind, with how many and the stamp of the first.
  std::vector<state::Notice> notices() const;
  /// What ended the log before its end, one line with file, byte and remedy; none yet or at all.
  const std::optional<std::string>& damage() const;

 private:
  std::unique_ptr<LogReading> reading_;
};

}  // namespace foucault::rawlog
