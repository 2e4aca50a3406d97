#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "guess_clock.h"
#include "guess_motion.h"
#include "guess_table.h"

/// Columns, units and axes of an IMU in a table of which nothing is told.
namespace foucault::rawlog {

using Triple = std::array<size_t, 3>;

struct ImuColumns {
  Triple gyro{}, accel{};
  Remark remark;
  std::string first;  ///< word of the names
};

/// None if the table has no gyroscopes and accelerometers.
std::optional<ImuColumns> imu_columns(const GuessTable& table);

/// Rows with all six values.
std::vector<bool> imu_rows(const GuessTable& table, const ImuColumns& columns);
ImuSeries imu_series(const GuessTable& table, const ImuColumns& columns,
                     const std::vector<double>& t);

/// A unit of a mapping, with the scale of counts.
struct UnitGuess {
  std::string unit;
  double scale = 1;
  Remark remark;
};

/// `step`: mean time between samples, for increments [s].
UnitGuess accel_unit(const std::string& named, const Gravity& gravity, bool counts, double step);
/// By turns or tilts where they are sure; `increments`: so are the accelerometer's.
UnitGuess gyro_unit(const std::string& named, const ImuSeries& imu, const Regression& turn,
                    bool counts, bool increments, double step);

/// Whether all values are whole numbers.
bool are_counts(const std::vector<Eigen::Vector3d>& values);

struct AxesGuess {
  std::vector<std::string> axes;  ///< forward, right, down
  Remark remark;
  bool reversed = false;  ///< accelerometers
  Remark sign;
};
/// `ios`: the names are those of a logger whose accelerometers are known to be reversed.
AxesGuess guess_axes(const Gravity& gravity, const std::optional<MotionMatch>& match, bool ios);

}  // namespace foucault::rawlog
