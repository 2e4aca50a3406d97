#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/measurement.h"

/// Importers: other people's files -> rawlog. All of them stream, write through RawlogWriter (whole
/// or not at all) and say in their summary what came in.
///
/// A row in which a merged table has no values (all cells blank or NaN) is counted.
/// A row that is wrong (number of columns, not a number, NaN, sigma zero or negative, stamp not
/// after the one before, or far ahead of those that follow) throws DataError with file:line and a
/// remedy, or is skipped and counted with `skip_bad_rows`. A log whose IMU and GNSS do not overlap
/// in time throws DataError. Wrong options or mappings throw UsageError.
namespace foucault::rawlog {

/// What all importers take.
struct ImportOptions {
  std::string out;  ///< rawlog to write
  bool skip_bad_rows = false;
  std::function<void(double)> progress;  ///< part done, 0 to 1; may be empty
};

/// One input stream.
struct ImportStream {
  std::string file;
  int64_t written = 0;
  int64_t skipped = 0;        ///< bad rows (skip_bad_rows)
  std::string first_skipped;  ///< why, with file:line
  int64_t without_fix = 0;    ///< rows that say there is no position, or are blank
  int64_t first_ns = 0;
  int64_t last_ns = 0;
  std::vector<std::string> notices;  ///< what was assumed or left out, a line each
};

struct ImportSummary {
  ImportStream imu;  ///< without a file if there is none
  ImportStream gnss;
  std::optional<ImportStream> reference;
  std::optional<ImportStream> wheel;  ///< if wheel speeds have a file of their own
  int64_t wheel_speeds = 0;
  int64_t with_velocity = 0;
  std::map<FixQuality, int64_t> qualities;
  /// IMU to antenna, forward-right-down [m]; none: not known, zero was written.
  std::optional<Eigen::Vector3d> lever_arm_v;
};

}  // namespace foucault::rawlog
