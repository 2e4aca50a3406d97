#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What the names of columns tell, as loggers of public repositories write them.
namespace foucault::rawlog {

/// A name cut into words: `gyroRotationX(rad/s)` is "gyro_rotation", axis 0, unit "rad_s".
struct ColumnName {
  std::string words;        ///< lower case, joined by _, without axis and unit
  std::optional<int> axis;  ///< 0, 1, 2 of x, y, z
  std::string unit;         ///< as mappings call it; empty without one
};

/// `unit` is what stands under the name, if anything.
ColumnName column_name(std::string_view name, std::string_view unit = {});

enum class Sensor { gyro, accelerometer };

/// The sensor of which the column is an axis.
std::optional<Sensor> sensor_of(const ColumnName& name);

/// The role of a GNSS or reference table that the name tells, as `velocity_north`; `height_msl` and
/// `height_ellipsoidal` where it says which, `week`, `date`; none if it tells nothing.
std::optional<std::string> role_of(const ColumnName& name);

/// Whether the name is that of a time.
bool is_time_name(const ColumnName& name);

/// Whether one of the words, or the start of one, is in the name.
bool has_word(const ColumnName& name, const std::vector<std::string>& starts);

}  // namespace foucault::rawlog
