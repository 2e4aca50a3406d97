#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/import.h"
#include "foucault/rawlog/import_mapping.h"

namespace foucault::rawlog {

/// A receiver's recording, and an IMU table told by a mapping, if there is one.
/// Fixes from raw observations are made by RTKLIB's programs (convbin, rnx2rtkp; Debian package
/// rtklib): with a base kinematic, forward and backward combined, without one single; position and
/// velocity with full covariances, velocity by Doppler. Throws DataError, naming the package, if
/// the programs are not there.
struct RawGnssImport : ImportOptions {
  std::string rover;             ///< RINEX observations, or UBX; plain or gzip, as all that follow
  std::vector<std::string> nav;  ///< RINEX navigation files, beside those of a UBX
  std::optional<std::string> base;            ///< RINEX observations, or UBX
  std::optional<Geodetic> base_position;      ///< of its antenna; without it the RINEX header's
  std::optional<std::string> rtklib_options;  ///< a file of rnx2rtkp (-k) instead of our own
  std::string mapping;                        ///< YAML; may be empty without a table
  std::optional<std::string> data_dir;
  std::optional<std::string> imu, reference, wheel;
  /// IMU to antenna, forward-right-down [m]; without it the mapping's.
  std::optional<Eigen::Vector3d> lever_arm;
};

/// RINEX 2 and 3. Of the mapping's `gnss` count: time.offset_s, velocity.
ImportSummary import_rinex(const RawGnssImport& options);

/// UBX of u-blox receivers. With a base, or without fixes of the receiver's own, its raw
/// observations (RXM-RAWX, RXM-RAW) go through RTKLIB. Otherwise fixes of three dimensions from
/// NAV-PVT, HPPOSLLH, COV, or of older receivers POSLLH, VELNED, SOL, STATUS, TIMEGPS, TIMEUTC,
/// joined by iTOW and stamped by GPS time, whatever the receiver takes for leap seconds.
/// Covariances are NAV-COV's, else of the accuracies: hAcc is of north and east together (measured:
/// hAcc^2 is the sum of COV's two), vAcc of down alone, sAcc of down, of north and east sAcc /
/// sqrt(2) (COV: 0.98 and 0.59).
/// IMU without a table: ESF-RAW, else ESF-MEAS, on the receiver's axes, of which z looks up. Its
/// clock is tied to GPS time by NAV-STATUS, else by the order of messages (a notice says so; what
/// remains is part of the time offset of IMU and GNSS). Throws UsageError then without a lever arm.
struct UbxImport : RawGnssImport {
  std::vector<std::string> imu_axes = {"x", "-y", "-z"};  ///< of its own IMU, as ImuMapping::axes
};

ImportSummary import_ubx(const UbxImport& options);

}  // namespace foucault::rawlog
