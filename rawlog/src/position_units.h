#pragma once

#include <string>
#include <vector>

#include "position_columns.h"

/// Units of positions that a mapping leaves to the data.
namespace foucault::rawlog {

/// Puts units in place of `auto`, found by the first 5000 rows. Angles: by their digits before the
/// decimal point and by their size; radians, all within 90 deg, and close together; else deg.
/// Heights: mm if they are whole numbers above 20 000, else m. Bearings: as angles, or 1e-5 deg
/// (e5) if they are whole numbers mostly above 360; `bearing_unit` is null where there are none.
/// Returns notices of what is not the usual unit.
/// Throws UsageError as Columns does.
std::vector<std::string> find_units(PositionMapping& mapping, std::string* bearing_unit,
                                    const std::string& section, const Roles& roles,
                                    const std::string& path);

}  // namespace foucault::rawlog
