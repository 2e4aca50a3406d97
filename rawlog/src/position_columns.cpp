#include "position_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "table_units.h"

namespace foucault::rawlog {

namespace {

const Roles kNed{"velocity_north", "velocity_east", "velocity_down"};
const Roles kNeu{"velocity_north", "velocity_east", "velocity_up"};
const Roles kLocal{"east", "north", "up"};

Geodetic origin_of(const OriginMapping& origin, const std::string& section,
                   const std::string& path) {
  if (origin.latitude_deg && origin.longitude_deg && origin.height_m) {
    return {*origin.latitude_deg * kDegree, *origin.longitude_deg * kDegree, *origin.height_m};
  }
  throw UsageError(fmt::format(
      "'{}' has positions in a local frame (east, north, up) and no place on Earth: give "
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

CoordinateColumns::CoordinateColumns(const std::string& role, const std::string& angle_unit,
                                     const Columns& columns)
    : section_(columns.section()),
      ddmm_(angle_unit == "ddmm"),
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
  const double value = degrees(row);
  if (value <= kTurn) return sign(row) * value * kDegree;
  const bool may_be_ddmm = value <= kLargestDdmm;
  row.fail(
      fmt::format("column {} is '{}', no place on Earth; if it is in {}, give {}.angle_unit: {}, "
                  "else correct or remove the row",
                  degrees_ + 1, row.text(degrees_), may_be_ddmm ? "ddmm.mmmm" : "1e-7 deg",
                  section_, may_be_ddmm ? "ddmm" : "e7"));
}

/// -0 is negative, too.
double CoordinateColumns::sign(const Row& row) const {
  const double side = std::signbit(row.number(degrees_)) ? -1 : 1;
  if (!hemisphere_) return side;
  const std::string_view letter = row.text(*hemisphere_);
  if (letter == "N" || letter == "E") return side;
  if (letter == "S" || letter == "W") return -side;
  row.fail(fmt::format("column {} is '{}', none of N, S, E, W; correct or remove the row",
                       *hemisphere_ + 1, letter));
}

/// Without sign.
double CoordinateColumns::degrees(const Row& row) const {
  constexpr double kParts = 60;
  const double value = std::abs(row.number(degrees_)) * factor_;
  const double whole = ddmm_ ? std::trunc(value / 100) : value;
  const double minutes = ddmm_ ? value - 100 * whole : minutes_ ? row.number(*minutes_) : 0;
  const double seconds = seconds_ ? row.number(*seconds_) : 0;
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
      height_offset_(height_offset(mapping.height, mapping.geoid_separation_m, columns.section())) {
  if (columns.has_all(kLocal)) {
    local_ = three(columns, kLocal);
    frame_.emplace(origin_of(mapping.origin, columns.section(), path));
    return;
  }
  geodetic_ = GeodeticColumns{{"latitude", mapping.angle_unit, columns},
                              {"longitude", mapping.angle_unit, columns},
                              columns.find("height")};
  if (geodetic_->height) return;
  const std::string& section = columns.section();
  const std::string instead = fmt::format(
      ", or give {}.height_m if there is none{}", section,
      section == "gnss" ? ", and in gnss.sigma_m [north, east, down] how far off it may be" : "");
  if (!mapping.height_m) columns.of("height", instead);
  height_m_ = *mapping.height_m;
}

bool PositionColumns::is_blank(const Row& row) const {
  if (frame_) {
    return std::all_of(local_.begin(), local_.end(), [&](size_t c) { return row.is_blank(c); });
  }
  return geodetic_->latitude.is_blank(row) && geodetic_->longitude.is_blank(row) &&
         (!geodetic_->height || row.is_blank(*geodetic_->height));
}

Geodetic PositionColumns::position(const Row& row) const {
  if (frame_) {
    const Eigen::Vector3d p = vector(row, local_) * height_factor_;
    return frame_->to_geodetic({p.y(), p.x(), -p.z()});
  }
  const double height =
      geodetic_->height ? row.number(*geodetic_->height) * height_factor_ : height_m_;
  return checked_position(row, geodetic_->latitude.radians(row), geodetic_->longitude.radians(row),
                          height + height_offset_);
}

Roles velocity_roles() { return {kNed[0], kNed[1], kNed[2], kNeu[2]}; }

std::optional<VelocityColumns> VelocityColumns::find(const PositionMapping& mapping,
                                                     const Columns& columns) {
  const double factor = unit_of(speed_units(), mapping.velocity_unit).factor;
  const auto found = [&](const Roles& roles, double down_sign) {
    return VelocityColumns(three(columns, roles), {factor, factor, down_sign * factor});
  };
  if (columns.has_all(kNed)) return found(kNed, 1);
  if (columns.has_all(kNeu)) return found(kNeu, -1);
  return std::nullopt;
}

bool VelocityColumns::is_blank(const Row& row) const {
  return std::any_of(columns_.begin(), columns_.end(), [&](size_t c) { return row.is_blank(c); });
}

Eigen::Vector3d VelocityColumns::velocity(const Row& row) const {
  return vector(row, columns_).cwiseProduct(factors_);
}

}  // namespace foucault::rawlog
