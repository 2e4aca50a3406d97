#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "guess_clock.h"
#include "guess_motion.h"
#include "guess_table.h"

/// Columns and units of positions, velocities, sigmas and qualities in a table of which nothing is
/// told.
namespace foucault::rawlog {

/// Columns of a table of positions by role, as indices.
struct FixColumns {
  std::map<std::string, size_t> roles;
  Remark remark;

  bool has(const std::string& role) const { return roles.count(role) > 0; }
  bool is_local() const { return !has("latitude"); }
  /// Attitude and position: a trajectory.
  bool is_pose() const { return has("roll") && has("pitch") && has("heading"); }
};

/// None if the table has no positions.
std::optional<FixColumns> fix_columns(const GuessTable& table);

std::vector<bool> fix_rows(const GuessTable& table, const FixColumns& columns);

/// Comments by key of the section, such as `angle_unit`.
using Remarks = std::map<std::string, Remark>;

/// What both sections have: columns, units, height. `angle_unit` first.
void guess_positions(const GuessTable& table, FixColumns& columns, PositionMapping& mapping,
                     Remarks& remarks);
/// What only fixes have: sigmas and qualities.
void guess_fixes(const GuessTable& table, const FixColumns& columns, const FixSeries& fixes,
                 GnssMapping& mapping, Remarks& remarks);

/// Fixes that differ from the one before; `t` a row each. Uses the mapping's units.
FixSeries fix_series(const GuessTable& table, const FixColumns& columns,
                     const PositionMapping& mapping, const std::vector<double>& t);
/// Unit of velocities by the way between fixes; finds latitude and longitude that are exchanged.
void check_velocities(const GuessTable& table, FixColumns& columns, FixSeries& fixes,
                      const std::vector<double>& t, GnssMapping& mapping, Remarks& remarks);

}  // namespace foucault::rawlog
