#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/state/interfaces.h"

/// The YAML mapping of the importers `csv`, `rtklib` and `nmea`: names files, columns, units, axes
/// and clocks of a recording.
namespace foucault::rawlog {

/// How the `time` column becomes a stamp. true time = stamp + offset_s.
class TimeMapping : public Configurable {
 public:
  /// gps_week_sow: columns `week` and `time`; gps_sow: seconds of the week `gps_week`, which may
  /// end; gps: seconds since 1980-01-06; unix: seconds since 1970, or as iso8601; iso8601: date and
  /// time of day in UTC or with their zone, in one column, in `date` and `time`, or in parts;
  /// seconds_of_day: of `date`, UTC, or hh:mm:ss, over midnight too; boot: since power-up, which
  /// was at second `boot_sow` of `gps_week`; excel, matlab_datenum: days of these programs, UTC.
  std::string system = "gps_week_sow";
  std::string unit = "s";  ///< of the `time` column: s | ms | us | ns | hhmmss
  std::optional<double> gps_week;
  std::string date;                 ///< YYYY-MM-DD
  std::string date_format;          ///< strptime's, of dates in columns; empty: what is certain
  std::optional<double> add_weeks;  ///< to the weeks of the column, where they are modulo 1024
  std::optional<double> boot_sow;
  double offset_s = 0;

  void fields(ConfigFields& f) override;
};

/// Which rows of a table count.
class RowsMapping : public Configurable {
 public:
  std::string column;  ///< name in the header, or number from 1
  std::string value;   ///< that it has in them; empty: all rows

  void fields(ConfigFields& f) override;
};

/// A text file in columns.
class TableMapping : public Configurable {
 public:
  std::string file;                            ///< relative to the mapping's own folder (or --data)
  std::string separator = "auto";              ///< auto | comma | semicolon | tab | space
  std::string decimal = "auto";                ///< auto | point | comma
  bool header = true;                          ///< a line, before the first row, names the columns
  std::map<std::string, std::string> columns;  ///< role -> name in the header, or number from 1
  RowsMapping rows;
  TimeMapping time;

  void fields(ConfigFields& f) override;
};

/// Roles: time, date, week, nanosecond, year, month, day, hour, minute, second; gyro_x, gyro_y,
/// gyro_z, accel_x, accel_y, accel_z, wheel_speed.
class ImuMapping : public TableMapping {
 public:
  /// auto (rad_s; rad beside increments of velocity) | rad_s | deg_s, or of increments rad | deg
  std::string gyro_unit = "auto";
  /// auto (by gravity, else m_s2) | m_s2 | g (9.80665 m/s^2) | mg | cm_s2, or increments m_s
  std::string accel_unit = "auto";
  std::string counts = "auto";  ///< auto | decimal | uint16 | hex
  double gyro_scale = 1;        ///< value in the column times this is in gyro_unit
  double accel_scale = 1;
  std::string wheel_speed_unit = "m_s";
  /// -1: at rest the axis that looks up shows -1 g, as phones have it (CoreMotion).
  std::string accel_sign = "1";
  /// Which sensor axis looks forward, right, down: each x, y or z with a sign. Data stay on the
  /// sensor's axes; this becomes the mounting.
  std::vector<std::string> axes = {"x", "y", "z"};
  /// Roll, pitch, heading [deg] of the sensor, on those axes, in the vehicle.
  Eigen::Vector3d mounting_rpy_deg = Eigen::Vector3d::Zero();
  /// What a run needs to know of the sensor, as in section `imu` of its configuration: how samples
  /// are to be read, noise. Goes into the notes of the log.
  imu::ImuOptions sensor;

  void fields(ConfigFields& f) override;
  /// Throws UsageError if `axes` is no right-handed set of three.
  state::Mounting mounting() const;
};

/// Place of a local frame East-North-Up.
class OriginMapping : public Configurable {
 public:
  std::optional<double> latitude_deg, longitude_deg, height_m;

  void fields(ConfigFields& f) override;
};

/// Positions. Roles: time, date, week; latitude, longitude, height, or east, north, up or down with
/// `origin`, or x, y, z of the Earth-fixed frame (ECEF); latitude_minutes, latitude_seconds,
/// latitude_hemisphere (N or S), and those of the longitude (E or W).
class PositionMapping : public TableMapping {
 public:
  /// auto (by the data, else deg) | deg | rad; of latitude, longitude: ddmm | ddmmss | e7 too
  std::string angle_unit = "auto";
  std::string height = "ellipsoidal";        ///< ellipsoidal | msl
  std::string height_unit = "auto";          ///< of the height, or of a frame's three columns
  std::optional<double> height_m;            ///< for tables without a height
  std::optional<double> geoid_separation_m;  ///< ellipsoidal height = msl + this
  OriginMapping origin;
  std::string velocity_unit = "m_s";  ///< of all velocity columns

  void fields(ConfigFields& f) override;
};

/// More roles: sigma_north, sigma_east, sigma_down, or sigma_horizontal, sigma_vertical, or
/// sigma_x, sigma_y, sigma_z; velocity_north, velocity_east, velocity_down or velocity_up, or
/// velocity_x, velocity_y, velocity_z, or speed, bearing; sigma_velocity; heading (of two
/// antennas), sigma_heading; quality; satellites, hdop, correction_age [s].
class GnssMapping : public PositionMapping {
 public:
  std::string bearing_unit = "auto";        ///< auto (as angle_unit) | deg | rad | e5 (1e-5 deg)
  std::string sigma_unit = "m";             ///< of the columns of positions' sigmas
  std::vector<double> sigma_m;              ///< north, east, down, where the file has none
  bool velocity = true;                     ///< read the velocity columns
  std::vector<double> velocity_sigma_m_s;   ///< north, east, down, where the file has none
  std::string heading_unit = "deg";         ///< deg | rad, of the heading and its sigma
  std::optional<double> heading_sigma_deg;  ///< where the file has none
  std::string quality = "unknown";          ///< of all fixes, without a quality column
  std::map<std::string, std::string> quality_table;  ///< value -> fixed_rtk ... unknown, or none

  void fields(ConfigFields& f) override;
};

/// More roles: velocity_north, velocity_east, velocity_down; roll, pitch, heading. Pose of the IMU.
class ReferenceMapping : public PositionMapping {};

/// Wheel speeds in a table of their own. Roles: time, date, week; speed (forward).
class WheelMapping : public TableMapping {
 public:
  std::string speed_unit = "m_s";

  void fields(ConfigFields& f) override;
};

/// The whole file.
class ImportMapping : public Configurable {
 public:
  ImuMapping imu;
  GnssMapping gnss;
  ReferenceMapping reference;
  WheelMapping wheel;
  std::vector<double> lever_arm_m;  ///< IMU to antenna, forward-right-down; empty: not known

  void fields(ConfigFields& f) override;
  /// Throws UsageError if `lever_arm_m` is neither empty nor three numbers.
  std::optional<Eigen::Vector3d> lever_arm() const;
};

}  // namespace foucault::rawlog
