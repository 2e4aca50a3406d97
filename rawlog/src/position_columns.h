#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "coordinate_text.h"
#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"
#include "table_columns.h"

/// Positions and velocities of a table.
namespace foucault::rawlog {

using Roles = std::vector<std::string>;

std::array<size_t, 3> three(const Columns& columns, const Roles& roles);
Eigen::Vector3d vector(const Row& row, const std::array<size_t, 3>& columns);

/// Radians a unit of a mapping's angles other than latitude and longitude.
double angle_factor(const std::string& angle_unit);

/// Roles of a position, and of a velocity.
const Roles& position_roles();
const Roles& velocity_roles();

/// Latitude or longitude: a number, or degrees, minutes and seconds in one cell or beside each
/// other, and N, S, E or W there or beside it.
class CoordinateColumns {
 public:
  CoordinateColumns(const std::string& role, const std::string& angle_unit, const Columns& columns);

  double radians(const Row& row) const;
  bool is_blank(const Row& row) const { return row.is_blank(degrees_); }

 private:
  CoordinateText text(const Row& row) const;
  double degrees(const Row& row, const CoordinateText& text) const;
  double sign(const Row& row, const CoordinateText& text) const;

  std::string section_;
  bool latitude_;
  std::string unit_;
  double factor_;  ///< to degrees
  size_t degrees_;
  std::optional<size_t> minutes_, seconds_, hemisphere_;
};

/// Positions of a table: geodetic, Earth-fixed (ECEF), or in a local frame with an origin.
class PositionColumns {
 public:
  PositionColumns(const PositionMapping& mapping, const Columns& columns, const std::string& path);

  /// Whether the row has no position.
  bool is_blank(const Row& row) const;
  Geodetic position(const Row& row) const;

 private:
  struct GeodeticColumns {
    CoordinateColumns latitude, longitude;
    std::optional<size_t> height;
  };

  Geodetic on_earth(const Row& row, const Eigen::Vector3d& p_e) const;
  Geodetic from_origin(const Row& row, const Eigen::Vector3d& p) const;

  double height_factor_;
  double height_offset_;
  double height_m_ = 0;                             ///< of rows without one
  std::optional<std::array<size_t, 3>> cartesian_;  ///< x, y, z, or north, east, down or up
  std::optional<geodesy::LocalFrame> frame_;        ///< none: Earth-fixed
  double down_sign_ = 1;
  std::string section_;
  std::optional<GeodeticColumns> geodetic_;
};

/// Velocities north, east, down, from three columns: those, up, or Earth-fixed (ECEF).
class VelocityColumns {
 public:
  /// None if the mapping has no such columns.
  static std::optional<VelocityColumns> find(const PositionMapping& mapping,
                                             const Columns& columns);

  /// Whether the row has no velocity.
  bool is_blank(const Row& row) const;
  /// At that place.
  Eigen::Vector3d velocity(const Row& row, const Geodetic& at) const;

 private:
  VelocityColumns(const std::array<size_t, 3>& columns, const Eigen::Vector3d& factors,
                  bool earth_fixed)
      : columns_(columns), factors_(factors), earth_fixed_(earth_fixed) {}

  std::array<size_t, 3> columns_;
  Eigen::Vector3d factors_;  ///< to m/s, down positive
  bool earth_fixed_;
};

}  // namespace foucault::rawlog
