#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

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

/// Latitude or longitude: a number, or degrees with minutes and seconds beside, and N, S, E or W.
class CoordinateColumns {
 public:
  CoordinateColumns(const std::string& role, const std::string& angle_unit, const Columns& columns);

  double radians(const Row& row) const;
  bool is_blank(const Row& row) const { return row.is_blank(degrees_); }

 private:
  double degrees(const Row& row) const;
  double sign(const Row& row) const;

  std::string section_;
  bool ddmm_;
  double factor_;  ///< to degrees
  size_t degrees_;
  std::optional<size_t> minutes_, seconds_, hemisphere_;
};

/// Positions of a table: geodetic, or in a local frame with an origin.
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

  double height_factor_;
  double height_offset_;
  double height_m_ = 0;  ///< of rows without one
  std::array<size_t, 3> local_{};
  std::optional<geodesy::LocalFrame> frame_;
  std::optional<GeodeticColumns> geodetic_;
};

/// Roles of a velocity: north, east, down or up.
Roles velocity_roles();

/// Velocities north, east, down, from three columns.
class VelocityColumns {
 public:
  /// None if the mapping has no such columns.
  static std::optional<VelocityColumns> find(const PositionMapping& mapping,
                                             const Columns& columns);

  /// Whether the row has no velocity.
  bool is_blank(const Row& row) const;
  Eigen::Vector3d velocity(const Row& row) const;

 private:
  VelocityColumns(const std::array<size_t, 3>& columns, const Eigen::Vector3d& factors)
      : columns_(columns), factors_(factors) {}

  std::array<size_t, 3> columns_;
  Eigen::Vector3d factors_;  ///< to m/s, down positive
};

}  // namespace foucault::rawlog
