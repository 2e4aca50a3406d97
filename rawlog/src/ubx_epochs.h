#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "foucault/core/measurement.h"
#include "foucault/core/time.h"
#include "ubx_file.h"

/// What a u-blox receiver's navigation messages (class NAV) say together of one epoch.
/// Source: u-blox ZED-F9P interface description (UBX-18010854), M8 protocol specification
/// (UBX-13003221), u-blox 6 protocol specification (GPS.G6-SW-10018).
namespace foucault::rawlog {

struct UbxPosition {
  Geodetic place;
  double horizontal = 0;  ///< accuracy hAcc: of north and east together [m]
  double vertical = 0;    ///< [m]
};

struct UbxVelocity {
  Eigen::Vector3d velocity_n;  ///< north, east, down [m/s]
  double accuracy = 0;         ///< sAcc [m/s]
};

/// How the receiver says it came to its position.
struct UbxStatus {
  enum class Kind { none, measured, fused, unknown };  ///< fused: with its own inertial sensors
  Kind kind = Kind::unknown;
  FixQuality quality = FixQuality::unknown;
};

struct UbxEpoch {
  int64_t byte = 0;               ///< where its first message begins
  int64_t tow_ms = 0;             ///< iTOW: GPS time of week, to the millisecond
  std::optional<int64_t> utc_ns;  ///< as the receiver counts leap seconds
  std::optional<GpsTime> gps;     ///< to the nanosecond
  std::optional<UbxStatus> status;
  std::optional<UbxPosition> precise;                  ///< HPPOSLLH
  std::optional<UbxPosition> standard;                 ///< PVT, POSLLH
  std::optional<UbxPosition> ecef;                     ///< SOL
  std::optional<UbxVelocity> velocity;                 ///< PVT, VELNED
  std::optional<UbxVelocity> ecef_velocity;            ///< SOL
  std::optional<Eigen::Matrix3d> position_covariance;  ///< north, east, down [m^2]
  std::optional<Eigen::Matrix3d> velocity_covariance;  ///< [m^2/s^2]
  std::optional<GnssHeading> heading;                  ///< RELPOSNED with a moving base
  bool position_invalid = false;

  const UbxPosition* position() const {
    if (position_invalid) return nullptr;
    return precise ? &*precise : standard ? &*standard : ecef ? &*ecef : nullptr;
  }
  const UbxVelocity* speed() const {
    return velocity ? &*velocity : ecef_velocity ? &*ecef_velocity : nullptr;
  }
};

/// Joins messages of one iTOW.
class UbxEpochs {
 public:
  explicit UbxEpochs(const std::string& path) : file_(path) {}

  /// None at the end. Throws RowError for a message that is shorter than its kind, and goes on
  /// behind it.
  std::optional<UbxEpoch> next();
  const UbxFile& file() const { return file_; }

 private:
  void take(const UbxMessage& message);

  UbxFile file_;
  std::optional<UbxEpoch> current_;
  std::optional<UbxEpoch> finished_;
};

}  // namespace foucault::rawlog
