#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import.h"

namespace foucault::rawlog {

/// A recording of a NovAtel receiver, ASCII, binary or both, among any other bytes; plain or gzip.
/// Source: docs.novatel.com, OEM7 Commands and Logs. Logs whose CRC is wrong are left out and
/// counted.
/// IMU: RAWIMUSX, RAWIMUX, RAWIMUS or RAWIMU, increments in counts by the type of the IMU, on the
///   axes of its enclosure; else IMURATECORRIMUS, CORRIMUDATAS, CORRIMUDATA or CORRIMUS, which the
///   receiver has corrected: its biases are out already, and gravity and the Earth's rate, which
///   are out too, are put back by the attitude of INSPVA. None: a log of fixes only.
/// GNSS: BESTGNSSPOS, else BESTPOS, RTKPOS, PPPPOS or PSRPOS, whichever is first among these with a
///   solution; heights above the sea, to which the log's undulation is added. Velocity: the log of
///   the same solution, at the stamp less its latency, brought to the fix by a line.
/// Reference: INSPVAS, INSPVA or INSPVAX while the solution is good; pose of the IMU's centre
/// unless
///   the receiver was told another place (SETINSTRANSLATION USER).
/// Time: GPS week and seconds.
/// Lever arm, mounting: INSCONFIG's ANT1 and RBV where the options do not give them; without RBV
/// the
///   IMU's y looks forward, x right, z up.
struct NovatelImport : ImportOptions {
  std::string log;
  std::optional<Eigen::Vector3d> lever_arm;  ///< IMU to antenna, forward-right-down [m]
  std::optional<std::string> imu_type;       ///< as INSCONFIG calls it, e.g. ADIS16488
  /// Gyroscope [rad] and accelerometer [m/s] of a count, for types that are not known here; of
  /// corrected logs, which old firmware does not sum up, the samples of the IMU that one stands
  /// for.
  std::optional<Eigen::Vector2d> imu_scales;
  std::vector<std::string> imu_axes;              ///< as ImuMapping::axes; empty: INSCONFIG's
  std::optional<Eigen::Vector3d> velocity_sigma;  ///< north, east, down [m/s]; the logs have none
};

ImportSummary import_novatel(const NovatelImport& options);

}  // namespace foucault::rawlog
