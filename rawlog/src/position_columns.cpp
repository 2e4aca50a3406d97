#include "position_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/geodesy/wgs84.h"
#include "table_units.h"

namespace foucault::rawlog {

namespace {

const Roles kNed{"velocity_north", "velocity_east", "velocity_down"};
const Roles kNeu{"velocity_north", "velocity_east", "velocity_up"};
const Roles kVelocityEcef{"velocity_x", "velocity_y", "velocity_z"};
const Roles kLocalUp{"north", "east", "up"};
const Roles kLocalDown{"north", "east", "down"};
const Roles kEcef{"x", "y", "z"};

Geodetic origin_of(const OriginMapping& origin, const std::string& section,
                   const std::string& path) {
  if (origin.latitude_deg && origin.longitude_deg && origin.height_m) {
    return {*origin.latitude_deg * kDegree, *origin.longitude_deg * kDegree, *origin.height_m};
  }
  throw UsageError(fmt::format(
      "'{}' has positions in a local frame (east, north, up or down) and no place on Earth: give "
      "{}.origin latitude_deg, longitude_deg and height_m (0.1 deg and 100 m are enough)",
      path, section));
}

double degrees_of(const std::string& angle_unit) {
  constexpr double kE7 = 1e-7;
  if (angle_unit == "rad") return 1 / kDegree;
  return angle_unit == "e7" ? kE7 : 1;
}

}  // namespace

std::array<size_t, 3> three(const Columns& columns, const Roles& roles) {
  return {columns.of(roles[0]), columns.of(roles[1]), columns.of(roles[2])};
}

Eigen::Vector3d vector(const Row& row, const std::array<size_t, 3>& columns) {
  return {row.number(columns[0]), row.number(columns[1]), row.number(columns[2])};
}

double angle_factor(const std::string& angle_unit) { return angle_unit == "rad" ? 1 : kDegree; }

const Roles& position_roles() {
  static const Roles roles{"latitude",
                           "longitude",
                           "height",
                           "latitude_minutes",
                           "latitude_seconds",
                           "latitude_hemisphere",
                           "longitude_minutes",
                           "longitude_seconds",
                           "longitude_hemisphere",
                           "east",
                           "north",
                           "up",
                           "down",
                           "x",
                           "y",
                           "z"};
  return roles;
}

const Roles& velocity_roles() {
  static const Roles roles{kNed[0],          kNed[1],          kNed[2],         kNeu[2],
                           kVelocityEcef[0], kVelocityEcef[1], kVelocityEcef[2]};
  return roles;
}

CoordinateColumns::CoordinateColumns(const std::string& role, const std::string& angle_unit,
                                     const Columns& columns)
    : section_(columns.section()),
      latitude_(role == "latitude"),
      unit_(angle_unit),
      factor_(degrees_of(angle_unit)),
      degrees_(columns.of(role)),
      minutes_(columns.find(role + "_minutes")),
      seconds_(columns.find(role + "_seconds")),
      hemisphere_(columns.find(role + "_hemisphere")) {
  if (seconds_ && !minutes_) columns.of(role + "_minutes");
  if (!minutes_ || angle_unit == "deg") return;
  throw UsageError(
      fmt::format("{}: {}_minutes stand beside degrees; leave angle_unit {} out, or the column",
                  columns.section(), role, angle_unit));
}

double CoordinateColumns::radians(const Row& row) const {
  constexpr double kTurn = 360;
  constexpr double kLargestDdmm = 18060;
  constexpr double kLargestDdmmss = 1806060;
  const CoordinateText coordinate = text(row);
  const double value = degrees(row, coordinate);
  if (value <= kTurn) return sign(row, coordinate) * value * kDegree;
  const auto [unit, key] = value <= kLargestDdmm     ? std::pair("ddmm.mmmm", "ddmm")
                           : value <= kLargestDdmmss ? std::pair("ddmmss.ss", "ddmmss")
                                                     : std::pair("1e-7 deg", "e7");
  row.fail(
      fmt::format("column {} is '{}', no place on Earth; if it is in {}, give {}.angle_unit: {}, "
                  "else correct or remove the row",
                  degrees_ + 1, row.text(degrees_), unit, section_, key));
}

CoordinateText CoordinateColumns::text(const Row& row) const {
  const std::optional<CoordinateText> found = coordinate_of(row.text(degrees_));
  if (found && (found->count == 1 || (unit_ == "deg" && !minutes_))) return *found;
  const double value = row.number(degrees_);  // as a table may spell it, or it says what it is
  return {{std::abs(value)}, 1, std::signbit(value), {}};
}

/// Minus and S or W say the same.
double CoordinateColumns::sign(const Row& row, const CoordinateText& text) const {
  std::optional<Hemisphere> side = text.hemisphere;
  if (hemisphere_) side = hemisphere_of(row.text(*hemisphere_));
  if (!side && !hemisphere_) return text.negative ? -1 : 1;
  const Hemisphere positive = latitude_ ? Hemisphere::north : Hemisphere::east;
  const Hemisphere negative = latitude_ ? Hemisphere::south : Hemisphere::west;
  if (side == negative) return -1;
  if (side == positive) return text.negative ? -1 : 1;
  const size_t column = hemisphere_.value_or(degrees_);
  row.fail(fmt::format("column {} is '{}', none of {}; correct or remove the row", column + 1,
                       row.text(column), latitude_ ? "N, S" : "E, W"));
}

/// Without sign.
double CoordinateColumns::degrees(const Row& row, const CoordinateText& text) const {
  constexpr double kParts = 60;
  double whole = text.parts[0] * factor_;
  double minutes = minutes_ ? row.number(*minutes_) : text.parts[1];
  double seconds = seconds_ ? row.number(*seconds_) : text.parts[2];
  if (unit_ == "ddmm") {
    minutes = std::fmod(whole, 100);
    whole = std::trunc(whole / 100);
  } else if (unit_ == "ddmmss") {
    seconds = std::fmod(whole, 100);
    minutes = std::fmod(std::trunc(whole / 100), 100);
    whole = std::trunc(whole / 10'000);
  }
  const auto is_part = [](double part) { return part >= 0 && part <= kParts; };
  if (!is_part(minutes) || !is_part(seconds)) {
    row.fail(
        fmt::format("minutes {:.9g} or seconds {:.9g} of an angle lie outside 0 to 60; check "
                    "columns and angle_unit, correct or remove the row",
                    minutes, seconds));
  }
  return whole + (minutes + seconds / kParts) / kParts;
}

PositionColumns::PositionColumns(const PositionMapping& mapping, const Columns& columns,
                                 const std::string& path)
    : height_factor_(unit_of(length_units(), mapping.height_unit).factor),
      height_offset_(height_offset(mapping.height, mapping.geoid_separation_m, columns.section())),
      section_(columns.section()) {
  const bool down = columns.has_all(kLocalDown);
  if (down || columns.has_all(kLocalUp)) {
    cartesian_ = three(columns, down ? kLocalDown : kLocalUp);
    down_sign_ = down ? 1 : -1;
    frame_.emplace(origin_of(mapping.origin, section_, path));
    return;
  }
  if (columns.has_all(kEcef)) {
    cartesian_ = three(columns, kEcef);
    return;
  }
  geodetic_ = GeodeticColumns{{"latitude", mapping.angle_unit, columns},
                              {"longitude", mapping.angle_unit, columns},
                              columns.find("height")};
  if (geodetic_->height) return;
  const std::string instead = fmt::format(
      ", or give {}.height_m if there is none{}", section_,
      section_ == "gnss" ? ", and in gnss.sigma_m [north, east, down] how far off it may be" : "");
  if (!mapping.height_m) columns.of("height", instead);
  height_m_ = *mapping.height_m;
}

bool PositionColumns::is_blank(const Row& row) const {
  if (cartesian_) {
    return std::all_of(cartesian_->begin(), cartesian_->end(),
                       [&](size_t c) { return row.is_blank(c); });
  }
  return geodetic_->latitude.is_blank(row) && geodetic_->longitude.is_blank(row) &&
         (!geodetic_->height || row.is_blank(*geodetic_->height));
}

Geodetic PositionColumns::position(const Row& row) const {
  if (cartesian_) {
    const Eigen::Vector3d p = vector(row, *cartesian_) * height_factor_;
    return frame_ ? from_origin(row, p) : on_earth(row, p);
  }
  const double height =
      geodetic_->height ? row.number(*geodetic_->height) * height_factor_ : height_m_;
  return checked_position(row, geodetic_->latitude.radians(row), geodetic_->longitude.radians(row),
                          height + height_offset_);
}

Geodetic PositionColumns::on_earth(const Row& row, const Eigen::Vector3d& p_e) const {
  constexpr double kNearest = 6e6;
  constexpr double kFarthest = 1e8;
  if (p_e.norm() > kNearest && p_e.norm() < kFarthest) return geodesy::wgs84::ecef_to_geodetic(p_e);
  row.fail(
      fmt::format("x {:.3f}, y {:.3f}, z {:.3f} m from the centre of the Earth (ECEF) are no place "
                  "on it; name the columns of a local frame east, north, up and give {}.origin, "
                  "else correct or remove the row",
                  p_e.x(), p_e.y(), p_e.z(), section_));
}

Geodetic PositionColumns::from_origin(const Row& row, const Eigen::Vector3d& p) const {
  constexpr double kFarthest = 1e6;
  if (p.norm() <= kFarthest) return frame_->to_geodetic({p.x(), p.y(), down_sign_ * p.z()});
  row.fail(
      fmt::format("north {:.3f}, east {:.3f} m lie {:.0f} km from {}.origin; if they are UTM or of "
                  "another map grid, convert them to latitude and longitude first (cs2cs of PROJ "
                  "does), else correct or remove the row",
                  p.x(), p.y(), p.norm() / 1000, section_));
}

std::optional<VelocityColumns> VelocityColumns::find(const PositionMapping& mapping,
                                                     const Columns& columns) {
  const double factor = unit_of(speed_units(), mapping.velocity_unit).factor;
  const auto found = [&](const Roles& roles, double down_sign, bool earth_fixed) {
    return VelocityColumns(three(columns, roles), {factor, factor, down_sign * factor},
                           earth_fixed);
  };
  if (columns.has_all(kNed)) return found(kNed, 1, false);
  if (columns.has_all(kNeu)) return found(kNeu, -1, false);
  if (columns.has_all(kVelocityEcef)) return found(kVelocityEcef, 1, true);
  return std::nullopt;
}

bool VelocityColumns::is_blank(const Row& row) const {
  return std::any_of(columns_.begin(), columns_.end(), [&](size_t c) { return row.is_blank(c); });
}

Eigen::Vector3d VelocityColumns::velocity(const Row& row, const Geodetic& at) const {
  const Eigen::Vector3d velocity = vector(row, columns_).cwiseProduct(factors_);
  if (!earth_fixed_) return velocity;
  return geodesy::wgs84::R_e_n(at.latitude, at.longitude).transpose() * velocity;
}

}  // namespace foucault::rawlog
