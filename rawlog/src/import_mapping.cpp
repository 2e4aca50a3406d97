#include "foucault/rawlog/import_mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "table_units.h"

namespace foucault::rawlog {

namespace {

const std::vector<std::string> kAngleUnits{"auto", "deg", "rad", "ddmm", "ddmmss", "e7"};
const std::vector<std::string> kHeights{"ellipsoidal", "msl"};
constexpr Range kAnyNumber{};
constexpr Range kSeconds{-1e9, 1e9};  // some thirty years

/// For a message, which is one line.
std::string quoted(std::string text) {
  constexpr size_t kLongest = 20;
  if (text.size() > kLongest) text = text.substr(0, kLongest - 3) + "...";
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return "'" + text + "'";
}

/// "x", "+y", "-z" as a unit vector of the sensor.
Eigen::RowVector3d axis(const std::string& name) {
  const bool negative = !name.empty() && name.front() == '-';
  const bool has_sign = negative || (!name.empty() && name.front() == '+');
  const std::string letter = name.substr(has_sign ? 1 : 0);
  if (letter != "x" && letter != "y" && letter != "z") {
    throw UsageError(
        fmt::format("imu.axes: {} is no axis; write x, y or z, with - if it looks the other way",
                    quoted(name)));
  }
  return (negative ? -1.0 : 1.0) * Eigen::RowVector3d::Unit(letter[0] - 'x');
}

Eigen::Matrix3d axes_matrix(const std::vector<std::string>& axes) {
  if (axes.size() != 3) {
    throw UsageError(
        fmt::format("imu.axes has {} entries; name the sensor axes that look forward, "
                    "right and down, e.g. [-x, y, -z]",
                    axes.size()));
  }
  Eigen::Matrix3d R;
  for (int row = 0; row < 3; ++row) R.row(row) = axis(axes[static_cast<size_t>(row)]);
  const double determinant = R.determinant();
  if (determinant < 0.5) {
    throw UsageError(fmt::format(
        "imu.axes [{}, {}, {}] {}; check the signs", axes[0], axes[1], axes[2],
        determinant < -0.5 ? "is left-handed, no IMU sits like that" : "names an axis twice"));
  }
  return R;
}

std::vector<std::string> or_auto(const Units& units) {
  std::vector<std::string> names = names_of(units);
  names.insert(names.begin(), "auto");
  return names;
}

}  // namespace

void TimeMapping::fields(ConfigFields& f) {
  f.text("system", system,
         {"gps_week_sow", "gps_sow", "gps", "unix", "iso8601", "seconds_of_day", "boot", "excel",
          "matlab_datenum"},
         "clock of the time column; iso8601: date and time in UTC or with their zone, in `time`, "
         "in `date` and `time`, or in year, month, day, hour, minute, second; excel and "
         "matlab_datenum: days, UTC");
  f.text("unit", unit, {"s", "ms", "us", "ns", "hhmmss"},
         "unit of the time column; hhmmss: of seconds_of_day written so, without colons");
  f.optional_number("gps_week", gps_week, {0, 10000}, "GPS week, for gps_sow and boot");
  f.text("date", date, {}, "YYYY-MM-DD, UTC, for seconds_of_day");
  f.text("date_format", date_format, {},
         "strptime's format of dates in columns, such as \"%d/%m/%Y\" or \"%d%m%y\"; empty: those "
         "that can be read in one way only");
  f.optional_number("add_weeks", add_weeks, {0, 10000},
                    "to the weeks of a column modulo 1024: 2048 since 2019-04-07, 1024 before");
  f.optional_number("boot_sow", boot_sow, kSeconds,
                    "second of the GPS week at which the boot clock was zero [s]");
  f.number("offset_s", offset_s, kSeconds, "true time = stamp + offset_s [s]");
}

void RowsMapping::fields(ConfigFields& f) {
  f.text("column", column, {}, "name in the header, or number from 1");
  f.text("value", value, {}, "what it has in the rows that count, such as $IMU; empty: all rows");
}

void TableMapping::fields(ConfigFields& f) {
  f.text("file", file, {}, "relative to the folder of this mapping, or to --data");
  f.text("separator", separator, {"auto", "comma", "semicolon", "tab", "space"},
         "between columns; auto: by header and rows");
  f.text("decimal", decimal, {"auto", "point", "comma"},
         "sign of decimals, the other one may stand between thousands; auto: a comma where it "
         "separates no columns and no number has a point");
  f.flag("header", header, "a line before the first row names the columns");
  f.text_map("columns", columns, "role: name in the header, or number from 1");
  f.section("rows", rows, "rows of one kind in a table of several");
  f.section("time", time, "clock");
}

void ImuMapping::fields(ConfigFields& f) {
  TableMapping::fields(f);
  f.text("gyro_unit", gyro_unit, or_auto(rate_units()),
         "unit of the angular rates; rad and deg: angle increments since the row before; auto: "
         "rad_s, or rad beside velocity increments");
  f.text("accel_unit", accel_unit, or_auto(acceleration_units()),
         "unit of the specific forces; m_s: velocity increments since the row before; auto: by "
         "gravity");
  f.text("counts", counts, {"auto", "decimal", "uint16", "hex"},
         "how numbers are written: uint16: two's complement of 16 bits as 0 to 65535; hex: two's "
         "complement in hexadecimal digits; auto: by the cells");
  f.number("gyro_scale", gyro_scale, kPositive, "of raw counts: value times this is in gyro_unit");
  f.number("accel_scale", accel_scale, kPositive,
           "of raw counts: value times this is in accel_unit");
  f.text("wheel_speed_unit", wheel_speed_unit, names_of(speed_units()), "unit of the wheel speed");
  f.text("accel_sign", accel_sign, {"1", "-1"},
         "-1 if an axis that looks up shows -1 g at rest, as phones have it");
  f.texts("axes", axes, "sensor axes that look forward, right, down, e.g. [-x, y, -z]");
  f.vector3("mounting_rpy_deg", mounting_rpy_deg,
            "roll, pitch, heading of the sensor, on those axes, in the vehicle [deg]");
  f.section("sensor", sensor,
            "what runs shall know of the IMU, as in section imu of their configuration");
}

state::Mounting ImuMapping::mounting() const {
  const Eigen::Vector3d rpy = mounting_rpy_deg * kDegree;
  const Eigen::Quaterniond axes_turn(axes_matrix(axes));
  return {(so3::from_euler({rpy.x(), rpy.y(), rpy.z()}) * axes_turn).normalized()};
}

void OriginMapping::fields(ConfigFields& f) {
  f.optional_number("latitude_deg", latitude_deg, {-90, 90}, "of the local frame's origin [deg]");
  f.optional_number("longitude_deg", longitude_deg, {-180, 360}, "of its origin [deg]");
  f.optional_number("height_m", height_m, kAnyNumber, "of its origin, ellipsoidal [m]");
}

void PositionMapping::fields(ConfigFields& f) {
  TableMapping::fields(f);
  f.text("angle_unit", angle_unit, kAngleUnits,
         "unit of angles; of latitude and longitude also ddmm (ddmm.mmmm), ddmmss (ddmmss.ss) and "
         "e7 (1e-7 deg); auto: by their size and digits, else deg");
  f.text("height", height, kHeights, "what heights count from");
  f.text("height_unit", height_unit, or_auto(length_units()),
         "unit of the height, or of east, north, up or x, y, z; auto: m, or mm if they are whole "
         "numbers above 20 000");
  f.optional_number("height_m", height_m, kAnyNumber,
                    "height of all rows of a table without one; gnss.sigma_m says how far off [m]");
  f.optional_number("geoid_separation_m", geoid_separation_m, kAnyNumber,
                    "ellipsoidal height = msl + this [m]");
  f.section("origin", origin, "of a local frame east, north, up or down");
  f.text("velocity_unit", velocity_unit, names_of(speed_units()),
         "unit of velocities, speed and their sigma");
}

void GnssMapping::fields(ConfigFields& f) {
  PositionMapping::fields(f);
  f.text("bearing_unit", bearing_unit, or_auto(bearing_units()),
         "unit of the bearing; e5: 1e-5 deg; auto: as the angles, or e5 if it is a whole number "
         "mostly above 360");
  f.text("sigma_unit", sigma_unit, names_of(length_units()), "unit of the sigma columns");
  f.numbers("sigma_m", sigma_m, kPositive,
            "north, east, down, where no column tells, or a cell of it is blank or zero [m]");
  f.flag("velocity", velocity, "read the velocity columns");
  f.numbers("velocity_sigma_m_s", velocity_sigma_m_s, kPositive,
            "north, east, down, where no column tells, or a cell of it is blank or zero [m/s]");
  f.text("heading_unit", heading_unit, {"deg", "rad"},
         "unit of the heading of two antennas and its sigma");
  f.optional_number("heading_sigma_deg", heading_sigma_deg, kPositive,
                    "where no column tells, or a cell of it is blank or zero; NMEA: 0.5");
  f.text("quality", quality, {"unknown", "single", "differential", "ppp", "float_rtk", "fixed_rtk"},
         "of all fixes, where no column tells");
  f.text_map("quality_table", quality_table, "value in the column: quality, or none");
}

void WheelMapping::fields(ConfigFields& f) {
  TableMapping::fields(f);
  f.text("speed_unit", speed_unit, names_of(speed_units()), "unit of the speed");
}

void ImportMapping::fields(ConfigFields& f) {
  f.section("imu", imu, "IMU table");
  f.section("gnss", gnss, "GNSS table");
  f.section("reference", reference, "reference trajectory, if there is one");
  f.section("wheel", wheel, "table of wheel speeds, if they have one of their own");
  f.numbers("lever_arm_m", lever_arm_m, kAnyNumber,
            "IMU to antenna, forward, right, down; empty: not known, zero is written [m]");
}

std::optional<Eigen::Vector3d> ImportMapping::lever_arm() const {
  if (lever_arm_m.empty()) return std::nullopt;
  if (lever_arm_m.size() != 3) {
    throw UsageError("lever_arm_m: give three numbers, [forward, right, down], or none");
  }
  return Eigen::Vector3d(lever_arm_m.data());
}

}  // namespace foucault::rawlog
